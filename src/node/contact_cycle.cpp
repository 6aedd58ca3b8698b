#include "node/contact_cycle.h"

#include <algorithm>
#include <cmath>

#include "node/conversions.h"
#include "node/stopwatch.h"

namespace organ_collision::node {

ContactCycle::ContactCycle(const io::Scene& scene, const Instruments& instruments,
                           const Organs& organs, const tf2::BufferCore& buffer)
    : scene_(scene), instruments_(instruments), organs_(organs), buffer_(buffer) {
  for (const io::Pair& pair : scene_.pairs) {
    tracked_.push_back({PairPose(
        {instruments_[pair.instrument].frame, organs_[pair.organ]->frame(), scene_.frame})});
  }
}

bool ContactCycle::lookUpTips() {
  bool news = false;
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    Tracked& tracked = tracked_[i];
    const std::uint32_t version = organs_[scene_.pairs[i].organ]->snapshot()->version;
    const bool moved = tracked.pose.lookUp(buffer_);
    news = news || moved || tracked.version != version;
    tracked.version = version;
  }
  return news;
}

Contact ContactCycle::contactOf(const io::Pair& pair, const OrganSnapshot& snapshot,
                                Tracked& tracked, const ros::Time& now,
                                const core::Accuracy& accuracy) {
  const PairPose& pose = tracked.pose;
  const Instrument& instrument = instruments_[pair.instrument];
  Organ& organ = *organs_[pair.organ];
  Contact contact;
  contact.instrument = instrument.name;
  contact.organ = organ.name();
  contact.mesh_version = snapshot.version;
  contact.status = Contact::NO_POSE;
  contact.nearest = noNearestTriangle(0.0);
  if (!pose.isKnown()) return contact;

  contact.stamp = pose.stamp();
  contact.age = pose.age(now);
  const core::Box box = core::boxOf(instrument.shapes, pose.secondFromFirst());
  core::Contact found{};
  found.colliding_certain = true;  // where boxes are that far apart
  found.nearest.lower_bound = std::sqrt(squaredDistance(box, snapshot.organ.health().box));
  found.nearest.tip_point = pose.secondFromFirst().translation();
  if (found.nearest.lower_bound <= scene_.max_distance) {
    found = tracked.tracker.contact(snapshot.organ, snapshot.travel, instrument.shapes,
                                    pose.secondFromFirst(), accuracy);
    organ.account(found.nearest.tip_point, accuracy);
  }
  const bool is_late = pose.isLate(now, scene_.stale_after);
  const bool is_apart = !found.colliding && found.colliding_certain;  // else perhaps deep inside
  const bool is_far = is_apart && found.nearest.lower_bound > scene_.max_distance;
  contact.status = statusOf(is_late, is_far);
  contact.nearest = is_far ? noNearestTriangle(found.nearest.lower_bound)
                           : toMessage(found.nearest, pose.sceneFromSecond());
  contact.instrument_point = toPoint(pose.sceneFromSecond() * found.nearest.tip_point);
  contact.colliding = found.colliding;
  contact.colliding_certain = found.colliding_certain;
  return contact;
}

ContactArray ContactCycle::contacts(const ros::Time& now, const core::Accuracy& accuracy) {
  const Stopwatch watch;
  ContactArray array;
  array.header.frame_id = scene_.frame;
  array.contacts.reserve(tracked_.size());
  const auto snapshots = snapshotsOf(organs_);
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    const io::Pair& pair = scene_.pairs[i];
    array.contacts.push_back(contactOf(pair, *snapshots[pair.organ], tracked_[i], now, accuracy));
    array.header.stamp = std::max(array.header.stamp, tracked_[i].pose.stampOfHeader(now));
  }
  array.computation_time = watch.elapsed();
  return array;
}

std::vector<Complaint> ContactCycle::complaints(const ros::Time& now) const {
  std::vector<Complaint> complaints;
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    const std::string reason = tracked_[i].pose.complaint(now, scene_.stale_after, buffer_);
    if (reason.empty()) continue;
    complaints.push_back({instruments_[scene_.pairs[i].instrument].name,
                          organs_[scene_.pairs[i].organ]->name(), reason});
  }
  return complaints;
}

}  // namespace organ_collision::node
