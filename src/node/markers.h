#pragma once

#include <organ_collision/ContactArray.h>
#include <organ_collision/ProximityArray.h>
#include <visualization_msgs/MarkerArray.h>

#include <cstddef>
#include <string>

#include "node/instrument.h"
#include "node/organ.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// Takes away whatever was shown before, by another scene's node most likely.
visualization_msgs::MarkerArray noMarkers(const std::string& frame);

/// The surface of an organ and its edges, in its own frame.
visualization_msgs::MarkerArray organMarkers(const Organ& organ);

/// The shapes that an instrument's contacts are of, see-through in its colour, in its own frame;
/// points and thin capsules are drawn a millimetre thick.
visualization_msgs::MarkerArray instrumentMarkers(const Instruments& instruments,
                                                  std::size_t number);

/// For each contact its nearest triangle in the instrument's colour (the first yellow, the second
/// green, as in the paper's Fig. 5), a line from tip to organ, the normal, and the distance in
/// words; nothing where there is no answer.
visualization_msgs::MarkerArray contactMarkers(const ContactArray& contacts, const io::Scene& scene,
                                               const Organs& organs);

/// For each pair of instruments or of organs the way between their nearest points, and the distance
/// in words; nothing where there is no answer.
visualization_msgs::MarkerArray proximityMarkers(const ProximityArray& proximities);

}  // namespace organ_collision::node
