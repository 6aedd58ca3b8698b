#pragma once

#include <string>
#include <vector>

#include "node/instrument.h"
#include "node/organ.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// With whom the scene pairs an organ: "left, right", or "no pair, but the services".
std::string partnersOfOrgan(const io::Scene& scene, std::size_t organ);

/// One sentence for each organ and instrument: what was built for whom, its memory, and the time
/// that took.
std::vector<std::string> report(const io::Scene& scene, const Instruments& instruments,
                                const Organs& organs);

}  // namespace organ_collision::node
