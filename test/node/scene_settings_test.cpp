#include <gtest/gtest.h>
#include <organ_collision/OrganCollisionConfig.h>

#include "organ_collision/io/scene.h"

namespace organ_collision::node {
namespace {

/// What a scene may say and dynamic_reconfigure not would be changed with the first other setting.
TEST(SceneSettings, MayBeAsLargeAsDynamicReconfigureAllows) {
  const OrganCollisionConfig& largest = OrganCollisionConfig::__getMax__();
  EXPECT_EQ(io::kLargestRelativeError, largest.max_relative_error);
  EXPECT_EQ(io::kLargestAbsoluteError, largest.max_absolute_error);
}

}  // namespace
}  // namespace organ_collision::node
