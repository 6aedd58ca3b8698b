#include "organ_collision/core/nearest_pair.h"

#include "core/nearest_pair_search.h"
#include "core/pair_sign.h"
#include "core/rigid_pose.h"

namespace organ_collision::core {

NearestPair nearestPair(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy) {
  requireUsable(accuracy);
  requireRigid(second_from_first);
  return withSign(first, second_from_first, second,
                  NearestPairSearch(first, second_from_first, second, accuracy).run());
}

}  // namespace organ_collision::core
