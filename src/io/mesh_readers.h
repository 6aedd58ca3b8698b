#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

// Each returns the mesh in the file's units, or throws std::invalid_argument naming the element at
// fault. Obj, ply, off and stl are read here because what there is does not do: tinyobjloader 2.0
// reads `nan` and `abc` as 0 and 0.3 as 0.30000000000000004, drops faces of two corners and splits
// quads by its own rule; assimp 5.2 renumbers obj, rounds all to float32, not always to the
// nearest, crashes on broken ply, and reads of a broken stl what it can.

/// Wavefront obj: its `v` and `f` lines; other known keywords are passed over, unknown ones
/// refused.
core::TriangleMesh readObj(std::string_view text);

/// Geomview off as text, with or without normals, colours and texture coordinates.
core::TriangleMesh readOff(std::string_view text);

/// Stanford ply, ascii or binary of either byte order: the elements vertex (x, y, z) and face
/// (vertex_indices).
core::TriangleMesh readPly(std::string_view bytes);

/// Stl, as text word for word or binary. Vertices of exactly one position are one vertex.
core::TriangleMesh readStl(std::string_view bytes);

/// Whatever assimp reads, in single precision, with node transforms applied. Vertices of exactly
/// one position are one vertex. Refused is what assimp logs as an error or as a loss of surface,
/// although it goes on; what is of another format than `extension` (".dae") says; a mesh that bones
/// move; and one below a node whose transform is not affine or presses it flat.
core::TriangleMesh readWithAssimp(const std::filesystem::path& file, const std::string& extension);

// Each throws for what assimp passes over without a word.

/// Of dae, a negative unit, which would mirror; axes of rotations that are not of length 1; indices
/// and counts of corners that are negative or no numbers; and counts of triangles, of which assimp
/// would pass over all.
void checkDae(std::string_view text);

/// Of gltf and glb, rotations that are not of length 1, and extensions without which they cannot be
/// read.
void checkGltf(std::string_view bytes);

}  // namespace organ_collision::io
