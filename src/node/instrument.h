#pragma once

#include <string>
#include <vector>

#include "organ_collision/core/instrument.h"

namespace organ_collision::node {

/// An instrument of the scene with its meshes read.
struct Instrument {
  std::string name;
  std::string frame;        ///< tf frame that the shapes are in
  core::Shapes shapes;      ///< none if the scene lists no pair with it
  double build_time = 0.0;  ///< [s] that their hierarchies took
};

using Instruments = std::vector<Instrument>;  // in the scene's order

}  // namespace organ_collision::node
