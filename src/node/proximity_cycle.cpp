#include "node/proximity_cycle.h"

#include <algorithm>
#include <cmath>

#include "convex/tool_proximity.h"
#include "node/conversions.h"
#include "node/stopwatch.h"

namespace organ_collision::node {
namespace {

/// The organ as a shape, in its own frame.
core::RigidMesh shapeOf(const std::shared_ptr<const OrganSnapshot>& snapshot) {
  return {{snapshot, &snapshot->organ}, Eigen::Isometry3d::Identity()};
}

}  // namespace

ProximityCycle::ProximityCycle(const io::Scene& scene, const Instruments& instruments,
                               const Organs& organs, const tf2::BufferCore& buffer)
    : scene_(scene), instruments_(instruments), organs_(organs), buffer_(buffer) {
  const auto frame_of = [&](io::LikePair::Of of, std::size_t i) {
    return of == io::LikePair::Of::kOrgans ? organs_[i]->frame() : instruments_[i].frame;
  };
  for (const io::LikePair& pair : scene_.like_pairs) {
    tracked_.push_back({pair, PairPose({frame_of(pair.of, pair.first),
                                        frame_of(pair.of, pair.second), scene_.frame})});
  }
}

const std::string& ProximityCycle::nameOf(io::LikePair::Of of, std::size_t i) const {
  return of == io::LikePair::Of::kOrgans ? organs_[i]->name() : instruments_[i].name;
}

bool ProximityCycle::lookUp() {
  bool news = false;
  for (Tracked& tracked : tracked_) {
    news = tracked.pose.lookUp(buffer_) || news;
    if (tracked.pair.of == io::LikePair::Of::kInstruments) continue;
    const std::array<std::uint32_t, 2> versions = {
        organs_[tracked.pair.first]->snapshot()->version,
        organs_[tracked.pair.second]->snapshot()->version};
    news = news || versions != tracked.versions;
    tracked.versions = versions;
  }
  return news;
}

Proximity ProximityCycle::measure(Tracked& tracked, const OrganSnapshots& snapshots,
                                  const core::Accuracy& accuracy) const {
  const Eigen::Isometry3d& pose = tracked.pose.secondFromFirst();
  const auto& [of, first, second] = tracked.pair;
  if (of == io::LikePair::Of::kInstruments) {
    const core::Shapes& shapes = instruments_[first].shapes;
    const core::Shapes& others = instruments_[second].shapes;
    // Errors alone stop no search here: contacts and pairs of organs are exact then, too.
    const core::Accuracy kept = accuracy.max_leaves != 0 ? accuracy : core::Accuracy::exact();
    return unlessFar(tracked, core::boxOf(shapes, pose),
                     core::boxOf(others, Eigen::Isometry3d::Identity()),
                     [&] { return convex::toolProximity(shapes, pose, others, kept); });
  }
  Organ& first_organ = *organs_[first];
  Organ& second_organ = *organs_[second];
  const auto& snapshot = snapshots[first];
  const auto& other_snapshot = snapshots[second];
  const core::Shape organ = core::transformed(shapeOf(snapshot), pose);
  const core::Shape other = shapeOf(other_snapshot);
  return unlessFar(tracked, core::boxOf(organ), core::boxOf(other), [&] {
    core::Proximity found =
        tracked.tracker.proximity(organ, snapshot->travel, other, other_snapshot->travel, accuracy);
    first_organ.account(pose.inverse() * found.point_on_second, accuracy);
    second_organ.account(found.point_on_first, accuracy);
    return found;
  });
}

template <class Measure>
Proximity ProximityCycle::unlessFar(const Tracked& tracked, const core::Box& first,
                                    const core::Box& second, const Measure& measure) const {
  const double apart = std::sqrt(squaredDistance(first, second));
  if (apart > scene_.max_distance) return noProximity(apart);
  const core::Proximity found = measure();
  if (found.lower_bound > scene_.max_distance) return noProximity(found.lower_bound);
  return toMessage(core::transformed(found, tracked.pose.sceneFromSecond()));
}

Proximity ProximityCycle::proximityOf(Tracked& tracked, const OrganSnapshots& snapshots,
                                      const ros::Time& now, const core::Accuracy& accuracy) const {
  Proximity message = noProximity(0.0);
  message.status = Contact::NO_POSE;
  if (tracked.pose.isKnown()) {
    const bool is_late = tracked.pose.isLate(now, scene_.stale_after);
    message = measure(tracked, snapshots, accuracy);
    const bool is_far = message.lower_bound > scene_.max_distance;
    message.status = statusOf(is_late, is_far);
    message.colliding_certain = message.colliding_certain || is_far;
    message.stamp = tracked.pose.stamp();
    message.age = tracked.pose.age(now);
  }
  const auto& [of, first, second] = tracked.pair;
  message.first = nameOf(of, first);
  message.second = nameOf(of, second);
  if (of == io::LikePair::Of::kOrgans) {
    message.mesh_version_of_first = snapshots[first]->version;
    message.mesh_version_of_second = snapshots[second]->version;
  }
  return message;
}

ProximityArray ProximityCycle::proximities(const ros::Time& now, const core::Accuracy& accuracy) {
  const Stopwatch watch;
  ProximityArray array;
  array.header.frame_id = scene_.frame;
  const OrganSnapshots snapshots = snapshotsOf(organs_);
  for (Tracked& tracked : tracked_) {
    array.proximities.push_back(proximityOf(tracked, snapshots, now, accuracy));
    array.header.stamp = std::max(array.header.stamp, tracked.pose.stampOfHeader(now));
  }
  array.computation_time = watch.elapsed();
  return array;
}

std::vector<Complaint> ProximityCycle::complaints(const ros::Time& now) const {
  std::vector<Complaint> complaints;
  for (const Tracked& tracked : tracked_) {
    const std::string reason = tracked.pose.complaint(now, scene_.stale_after, buffer_);
    if (reason.empty()) continue;
    complaints.push_back({nameOf(tracked.pair.of, tracked.pair.first),
                          nameOf(tracked.pair.of, tracked.pair.second), reason});
  }
  return complaints;
}

}  // namespace organ_collision::node
