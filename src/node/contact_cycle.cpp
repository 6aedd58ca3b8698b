#include "node/contact_cycle.h"

#include <algorithm>
#include <chrono>

#include "node/conversions.h"

namespace organ_collision::node {
namespace {

/// Zero for static transforms, which are always true.
ros::Duration ageOf(const FramePose& pose, const ros::Time& now) {
  return pose.stamp.isZero() ? ros::Duration(0) : now - pose.stamp;
}

}  // namespace

ContactCycle::ContactCycle(const io::Scene& scene, const Organs& organs,
                           const tf2::BufferCore& buffer)
    : scene_(scene), organs_(organs), buffer_(buffer), tracked_(scene.pairs.size()) {}

bool ContactCycle::lookUpTips() {
  bool news = false;
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    Tracked& tracked = tracked_[i];
    const Organ& organ = *organs_[scene_.pairs[i].organ];
    const std::string& tip_frame = scene_.instruments[scene_.pairs[i].instrument].frame;

    const FrameLookup tip = lookUpFrame(buffer_, organ.frame(), tip_frame);
    tracked.reason = tip.reason;
    if (tip.pose) {
      news = news || !tracked.organ_from_tip || tracked.organ_from_tip->stamp != tip.pose->stamp;
      tracked.organ_from_tip = tip.pose;
    }
    FrameLookup scene =
        lookUpFrame(buffer_, scene_.frame, organ.frame(), tip.pose ? tip.pose->stamp : ros::Time());
    if (!scene.pose) scene = lookUpFrame(buffer_, scene_.frame, organ.frame());
    if (scene.pose) tracked.scene_from_organ = scene.pose;
    if (tracked.reason.empty()) tracked.reason = scene.reason;

    const std::uint32_t version = organ.snapshot()->version;
    news = news || tracked.version != version;
    tracked.version = version;
  }
  return news;
}

bool ContactCycle::isStale(const Tracked& tracked, const ros::Time& now) const {
  return !tracked.reason.empty() ||
         ageOf(*tracked.organ_from_tip, now).toSec() > scene_.stale_after;
}

Contact ContactCycle::contactOf(const io::Pair& pair, const Tracked& tracked, const ros::Time& now,
                                const core::Accuracy& accuracy) const {
  const io::Instrument& instrument = scene_.instruments[pair.instrument];
  Organ& organ = *organs_[pair.organ];
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  Contact contact;
  contact.instrument = instrument.name;
  contact.organ = organ.name();
  contact.mesh_version = snapshot->version;
  contact.status = Contact::NO_POSE;
  contact.nearest = noNearestTriangle(0.0);
  if (!tracked.organ_from_tip || !tracked.scene_from_organ) return contact;

  const auto& [organ_from_tip, stamp] = *tracked.organ_from_tip;
  const Eigen::Isometry3d& scene_from_organ = tracked.scene_from_organ->target_from_source;
  const core::Contact found =
      core::contact(snapshot->organ, core::transformed(instrument.shape, organ_from_tip), accuracy);
  organ.account(*snapshot, found.nearest.work);
  contact.stamp = stamp;
  contact.age = ageOf(*tracked.organ_from_tip, now);
  contact.status = isStale(tracked, now) ? Contact::STALE : Contact::OK;
  contact.instrument_point = toPoint(scene_from_organ * found.nearest.tip_point);
  if (found.nearest.lower_bound > scene_.max_distance) {
    if (contact.status == Contact::OK) contact.status = Contact::OUT_OF_RANGE;
    contact.nearest = noNearestTriangle(found.nearest.lower_bound);
    return contact;
  }
  contact.nearest = toMessage(found.nearest, scene_from_organ);
  contact.colliding = found.colliding;
  contact.colliding_certain = found.colliding_certain;
  return contact;
}

ContactArray ContactCycle::contacts(const ros::Time& now, const core::Accuracy& accuracy) const {
  const auto start = std::chrono::steady_clock::now();
  ContactArray array;
  array.header.frame_id = scene_.frame;
  array.contacts.reserve(tracked_.size());
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    array.contacts.push_back(contactOf(scene_.pairs[i], tracked_[i], now, accuracy));
    array.header.stamp = std::max(array.header.stamp, array.contacts.back().stamp);
  }
  array.computation_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return array;
}

std::vector<ContactCycle::Complaint> ContactCycle::complaints(const ros::Time& now) const {
  std::vector<Complaint> complaints;
  for (std::size_t i = 0; i < tracked_.size(); ++i) {
    const Tracked& tracked = tracked_[i];
    std::string reason = tracked.reason;
    if (reason.empty() && isStale(tracked, now)) {
      reason = "the last pose is " + std::to_string(ageOf(*tracked.organ_from_tip, now).toSec()) +
               " s old";
    }
    if (reason.empty()) continue;
    complaints.push_back({scene_.instruments[scene_.pairs[i].instrument].name,
                          organs_[scene_.pairs[i].organ]->name(), reason});
  }
  return complaints;
}

}  // namespace organ_collision::node
