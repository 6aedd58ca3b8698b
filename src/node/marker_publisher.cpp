#include "node/marker_publisher.h"

#include <ros/topic_manager.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "node/markers.h"

namespace organ_collision::node {
namespace {

constexpr double kAllPeriod = 2.0;  // [s]
constexpr unsigned kMarkersQueue = 2;

}  // namespace

MarkerPublisher::MarkerPublisher(const io::Scene& scene, const Instruments& instruments,
                                 const Organs& organs)
    : scene_(scene), instruments_(instruments), organs_(organs), drawn_versions_(organs.size()) {}

void MarkerPublisher::advertise(ros::NodeHandle& node) {
  publisher_ = node.advertise<visualization_msgs::MarkerArray>("markers", kMarkersQueue);
}

void MarkerPublisher::publish(const Cycle& cycle) {
  const std::uint32_t listeners = publisher_.getNumSubscribers();
  const bool is_new = listeners > std::exchange(listeners_, listeners);
  if (listeners == 0) return;
  const ros::SteadyTime now = ros::SteadyTime::now();
  const bool draws_all = is_new || (now - all_drawn_).toSec() > kAllPeriod;
  visualization_msgs::MarkerArray markers;
  const auto add = [&markers](visualization_msgs::MarkerArray more) {
    std::move(more.markers.begin(), more.markers.end(), std::back_inserter(markers.markers));
  };
  if (is_new) add(noMarkers(scene_.frame));  // of a former node it has some, perhaps
  add(contactMarkers(cycle.contacts, scene_, organs_));
  add(proximityMarkers(cycle.proximities));
  for (std::size_t i = 0; i < organs_.size(); ++i) {
    const std::uint32_t version = organs_[i]->snapshot()->version;
    if (std::exchange(drawn_versions_[i], version) != version || draws_all)
      add(organMarkers(*organs_[i]));
  }
  for (std::size_t i = 0; draws_all && i < instruments_.size(); ++i)
    add(instrumentMarkers(instruments_, i));
  if (draws_all) all_drawn_ = now;
  // Written down here: Publisher would do so while it holds the lock that contacts want.
  ros::SerializedMessage written = ros::serialization::serializeMessage(markers);
  ros::SerializedMessage message;
  ros::TopicManager::instance()->publish(
      publisher_.getTopic(), [&written] { return written; }, message);
}

}  // namespace organ_collision::node
