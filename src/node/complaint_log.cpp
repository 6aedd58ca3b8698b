#include "node/complaint_log.h"

#include <ros/console.h>

#include <utility>

namespace organ_collision::node {
namespace {

constexpr double kPatience = 1.0;              // [s] before the first warning about a pair
constexpr double kPeriod = LogLimit::kPeriod;  // between warnings about one pair

}  // namespace

void ComplaintLog::note(const std::string& complaint) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (limit_.allows(complaint)) noted_.push_back(complaint);
}

void ComplaintLog::write(const std::vector<Complaint>& of_pairs) {
  writeOfPairs(of_pairs);
  std::vector<std::string> noted;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    noted.swap(noted_);
  }
  for (const std::string& complaint : noted) ROS_WARN("%s", complaint.c_str());
}

void ComplaintLog::writeOfPairs(const std::vector<Complaint>& complaints) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  std::map<std::string, ros::SteadyTime> write_at;
  for (const Complaint& complaint : complaints) {
    const std::string pair = complaint.first + " to " + complaint.second;
    const auto known = write_at_.find(pair);
    ros::SteadyTime& due = write_at[pair] =
        known == write_at_.end() ? now + ros::WallDuration(kPatience) : known->second;
    if (now < due) continue;
    due = now + ros::WallDuration(kPeriod);
    ROS_WARN("%s: %s", pair.c_str(), complaint.reason.c_str());
  }
  write_at_ = std::move(write_at);  // who has nothing to complain of any more starts anew
}

}  // namespace organ_collision::node
