#include "node/mesh_update_intake.h"

#include <exception>
#include <string>
#include <utility>

#include "node/conversions.h"

namespace organ_collision::node {
namespace {

/// Taken in faster than they come: each is only added to what waits. But a processor may be busy
/// for a while, and what of them is dropped, nobody may send again.
constexpr unsigned kUpdatesQueue = 10'000;

bool isLatched(const ros::MessageEvent<MeshUpdate const>& event) {
  const auto entry = event.getConnectionHeader().find("latching");
  return entry != event.getConnectionHeader().end() && entry->second == "1";
}

}  // namespace

MeshUpdateIntake::MeshUpdateIntake(const Organs& organs, Incidents& refusals, ComplaintLog& log,
                                   std::function<void()> tell_refusal)
    : organs_(organs),
      refusals_(refusals),
      log_(log),
      tell_refusal_(std::move(tell_refusal)),
      spinner_(1, &queue_) {}

void MeshUpdateIntake::subscribe(ros::NodeHandle node) {
  node.setCallbackQueue(&queue_);
  subscriber_ = node.subscribe("mesh_update", kUpdatesQueue, &MeshUpdateIntake::take, this,
                               ros::TransportHints().tcpNoDelay());
  spinner_.start();
}

void MeshUpdateIntake::take(const Event& event) {
  const MeshUpdate& update = *event.getConstMessage();
  missed_ += missedBefore(event);
  try {
    Organ& organ = organNamed(organs_, update.organ);
    organ.countLostUpdates(std::exchange(missed_, 0));  // its own, most likely
    enqueue(organ, update);
  } catch (const std::exception& error) {
    const std::string refusal = "an update of the mesh of '" + update.organ + "' by '" +
                                event.getPublisherName() + "': " + error.what();
    log_.refuse("refused " + refusal);
    refusals_.note(refusal);
  }
}

/// How many updates of this one's publisher did not come.
std::uint32_t MeshUpdateIntake::missedBefore(const Event& event) {
  const std::string& publisher = event.getPublisherName();
  const std::uint32_t missed = gaps_.before(publisher, event.getConstMessage()->header.seq);
  // rospy counts up for each one that subscribes to what is latched.
  if (missed == 0 || isLatched(event)) return 0;
  log_.warn(std::to_string(missed) + " mesh updates of '" + publisher +
            "' were lost on the way here");
  return missed;
}

void MeshUpdateIntake::enqueue(Organ& organ, const MeshUpdate& update) {
  try {
    organ.requireFrame(update.header.frame_id);
    organ.enqueue(movesFrom(update));
  } catch (const std::exception&) {
    organ.countLostUpdates(1);
    tell_refusal_();
    throw;
  }
}

}  // namespace organ_collision::node
