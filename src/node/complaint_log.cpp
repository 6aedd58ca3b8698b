#include "node/complaint_log.h"

#include <ros/console.h>

#include <string_view>
#include <utility>

#include "organ_collision/io/message_text.h"

namespace organ_collision::node {
namespace {

constexpr double kPatience = 1.0;              // [s] before the first warning about a pair
constexpr double kPeriod = LogLimit::kPeriod;  // between warnings about one pair
constexpr std::size_t kMostNoted = 100;        // that wait while the console blocks

}  // namespace

void ComplaintLog::note(Noted noted) {
  noted.complaint = io::printable(noted.complaint);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (noted_.size() < kMostNoted && limit_.allows(noted.complaint))
    noted_.push_back(std::move(noted));
}

void ComplaintLog::write(const std::vector<Complaint>& of_pairs) {
  writeOfPairs(of_pairs);
  std::vector<Noted> all;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    all.swap(noted_);
  }
  for (const Noted& noted : all) {
    if (noted.is_error) {
      ROS_ERROR("%s", noted.complaint.c_str());
    } else {
      ROS_WARN("%s", noted.complaint.c_str());
    }
  }
}

void ComplaintLog::writeOfPairs(const std::vector<Complaint>& complaints) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  std::map<std::string, ros::SteadyTime> write_at;
  std::map<std::string, std::vector<std::string_view>> told;  // the pairs, by the reason
  for (const Complaint& complaint : complaints) {
    const std::string pair = complaint.first + " to " + complaint.second;
    const auto known = write_at_.find(pair);
    const ros::SteadyTime due =
        known == write_at_.end() ? now + ros::WallDuration(kPatience) : known->second;
    const bool is_due = due <= now;
    const auto noted = write_at.emplace(pair, is_due ? now + ros::WallDuration(kPeriod) : due);
    if (is_due) told[complaint.reason].push_back(noted.first->first);
  }
  for (const auto& [reason, pairs] : told)
    ROS_WARN("%s: %s", io::printable(io::joined(pairs)).c_str(), reason.c_str());
  write_at_ = std::move(write_at);  // who has nothing to complain of any more starts anew
}

}  // namespace organ_collision::node
