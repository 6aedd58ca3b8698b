#include "node/diagnostics.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace organ_collision::node {
namespace {

using diagnostic_msgs::DiagnosticStatus;

/// How large the organ is, or how many triangles have no area, is no news.
std::vector<std::string> kindsOf(const std::vector<std::string>& sentences) {
  std::vector<std::string> kinds;
  std::transform(sentences.begin(), sentences.end(), std::back_inserter(kinds), withoutNumbers);
  return kinds;
}

/// A warning each time that there are more of them.
void diagnoseNews(const std::string& what, Incidents& incidents,
                  diagnostic_updater::DiagnosticStatusWrapper& status) {
  const Incidents::News news = incidents.takeNews();
  status.add(what, news.count);
  if (news.more == 0) return;
  status.mergeSummary(DiagnosticStatus::WARN,
                      what + ": " + std::to_string(news.more) + ", the last " + news.last);
}

}  // namespace

DiagnosticStatus flowOf(const Cycle& last, const ros::SteadyTime& now) {
  constexpr double kLongestPause = 1.0;  // [s] ten times that of a node that hears of no pose
  DiagnosticStatus status;
  const double pause = (now - last.published).toSec();
  if (last.published.isZero()) {
    status.level = DiagnosticStatus::WARN;
    status.message = "no contacts yet";
  } else if (pause > kLongestPause) {
    status.level = DiagnosticStatus::ERROR;
    status.message = "no contacts for " + std::to_string(pause) + " s";
  } else {
    status.message = "contacts flow";
  }
  return status;
}

Diagnostics::Diagnostics(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                         const Organs& organs, Troubles& troubles, const MasterWatch& master,
                         ComplaintLog& log,
                         std::function<std::shared_ptr<const Cycle>()> last_cycle)
    : organs_(organs),
      troubles_(troubles),
      master_(master),
      log_(log),
      last_cycle_(std::move(last_cycle)),
      surface_checks_(organs.size()),
      updater_(node, private_node, ros::this_node::getName()) {
  for (const auto& organ : organs)
    health_told_.push_back(kindsOf(core::warnings(organ->snapshot()->organ.health())));
  updater_.setHardwareID("none");
  updater_.add("contacts", this, &Diagnostics::diagnose);
}

/// Not update(), which waits for ROS time: that may stand still or jump back.
void Diagnostics::publish() { updater_.force_update(); }

void Diagnostics::diagnose(Status& status) {
  const std::shared_ptr<const Cycle> cycle = last_cycle_();
  status.summary(flowOf(*cycle, ros::SteadyTime::now()));
  for (const Complaint& complaint : cycle->complaints) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        complaint.first + " to " + complaint.second + ": " + complaint.reason);
  }
  diagnoseClock(status);
  diagnoseMaster(status);
  diagnoseHaste(status);
  diagnoseNews("complaints about tf", troubles_.tf_complaints, status);
  diagnoseNews("mesh updates refused", troubles_.update_refusals, status);
  status.add("computation time of the last cycle [us]", 1e6 * cycle->contacts.computation_time);
  for (std::size_t i = 0; i < organs_.size(); ++i) diagnoseOrgan(i, status);
}

/// The log is told, too: all else that is to be seen is that no pose comes.
void Diagnostics::diagnoseClock(Status& status) {
  if (!ros::Time::isSimTime() || !ros::Time::now().isZero()) return;
  const std::string sentence = "use_sim_time is set, but /clock stands at 0";
  status.mergeSummary(DiagnosticStatus::WARN, sentence);
  log_.warn(sentence);
}

/// The log, too: who asks the master for diagnostics learns nothing then.
void Diagnostics::diagnoseMaster(Status& status) {
  const std::string sentence = master_.complaint();
  if (sentence.empty()) return;
  status.mergeSummary(DiagnosticStatus::WARN, sentence);
  log_.warn(sentence);
}

/// A warning each time that it happened again.
void Diagnostics::diagnoseHaste(Status& status) {
  const std::uint64_t times = troubles_.times_behind;
  status.add("times that poses were left out", times);
  if (times == std::exchange(times_behind_told_, times)) return;
  status.mergeSummary(DiagnosticStatus::WARN,
                      "this machine cannot keep up with tf: poses are left out");
}

void Diagnostics::diagnoseOrgan(std::size_t number, Status& status) {
  Organ& organ = *organs_[number];
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  std::vector<std::string> sentences = core::warnings(snapshot->organ.health());
  const std::string& crossing = surface_checks_[number].complaint(snapshot);
  if (!crossing.empty()) sentences.push_back(crossing);
  for (const std::string& sentence : sentences)
    status.mergeSummary(DiagnosticStatus::WARN, organ.name() + ": " + sentence);
  warnOfHealth(number, sentences);
  status.add(organ.name() + " mesh version", snapshot->version);
  status.add(organ.name() + " last action", snapshot->reason);
  const Organ::Builds builds = organ.builds();
  status.add(organ.name() + " builds", builds.count);
  status.add(organ.name() + " last build", builds.reason);
  status.add(organ.name() + " since then", builds.figures);
  if (!builds.failure.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN,
                        organ.name() + " could not be rebuilt: " + builds.failure);
  }
  status.add(organ.name() + " cost ratio", organ.costRatio());
  const Organ::Counters counters = organ.counters();
  status.add(organ.name() + " updates merged", counters.updates_merged);
  status.add(organ.name() + " updates lost", counters.updates_lost);
}

/// What was not told when the organ was loaded, nor since.
void Diagnostics::warnOfHealth(std::size_t organ, const std::vector<std::string>& sentences) {
  const std::vector<std::string>& known = health_told_[organ];
  const std::string name = "'" + organs_[organ]->name() + "', as it is now: ";
  for (const std::string& sentence : sentences) {
    if (std::count(known.begin(), known.end(), withoutNumbers(sentence)) > 0) continue;
    log_.warn(name + sentence);
  }
  health_told_[organ] = kindsOf(sentences);
}

}  // namespace organ_collision::node
