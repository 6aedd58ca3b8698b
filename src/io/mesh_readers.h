#pragma once

#include <filesystem>
#include <string_view>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

// Each returns the mesh in the file's units, or throws std::invalid_argument naming the element at
// fault. Obj, ply and off are read here because what there is does not do: tinyobjloader 2.0 reads
// `nan` and `abc` as 0 and 0.3 as 0.30000000000000004, drops faces of two corners and splits quads
// by its own rule; assimp 5.2 renumbers obj, rounds all to float32 and crashes on broken ply.

/// Wavefront obj: its `v` and `f` lines; other known keywords are passed over, unknown ones
/// refused.
core::TriangleMesh readObj(std::string_view text);

/// Geomview off as text, with or without normals, colours and texture coordinates.
core::TriangleMesh readOff(std::string_view text);

/// Stanford ply, ascii or binary of either byte order: the elements vertex (x, y, z) and face
/// (vertex_indices).
core::TriangleMesh readPly(std::string_view bytes);

/// Whatever assimp reads, with node transforms applied. Vertices of exactly one position are one
/// vertex.
core::TriangleMesh readWithAssimp(const std::filesystem::path& file);

}  // namespace organ_collision::io
