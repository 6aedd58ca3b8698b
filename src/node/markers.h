#pragma once

#include <organ_collision/ContactArray.h>
#include <visualization_msgs/MarkerArray.h>

#include "node/contact_cycle.h"

namespace organ_collision::node {

/// The surface of an organ and its edges, in its own frame.
visualization_msgs::MarkerArray organMarkers(const Organ& organ);

/// For each contact its nearest triangle in the instrument's colour (the first yellow, the second
/// green, as in the paper's Fig. 5), a line from tip to organ, the normal, and the distance in
/// words; nothing where there is no answer.
visualization_msgs::MarkerArray contactMarkers(const ContactArray& contacts, const io::Scene& scene,
                                               const Organs& organs);

}  // namespace organ_collision::node
