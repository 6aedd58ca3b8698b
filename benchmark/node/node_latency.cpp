// How long after an instrument has moved does everybody know its contact? Moves eight instruments
// a thousand times a second over an organ that deforms, and receives the node's contacts.
//
// A latency lasts from just before the transforms are published on /tf until the callback of
// ~contacts is called with a contact of their stamp: two hops over TCP and the node between them.
// Where the sender itself gets no processor it sends late, and that wait is not counted.
#include <organ_collision/ContactArray.h>
#include <organ_collision/GetMesh.h>
#include <organ_collision/MeshUpdate.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <thread>

#include "organs.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/program.h"
#include "tools/statistics.h"
#include "workloads.h"

namespace organ_collision::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kInstruments = 8;
constexpr double kRate = 1000.0;           // [1/s]
constexpr double kWarmUp = 1.0;            // [s] not counted
constexpr double kPatience = 30.0;         // [s] until the node is there
constexpr double kLastContact = 0.5;       // [s] for what is still on its way
constexpr std::size_t kPathLength = 4000;  // tips, walked to and fro
constexpr std::size_t kShapes = 30;        // of the organ
constexpr double kDent = 0.01;             // [diagonal]
constexpr const char* kFrame = "organ";
constexpr double kLost = std::numeric_limits<double>::infinity();  // [s] until a contact came

std::string instrumentName(std::size_t i) { return "tip_" + std::to_string(i); }

Clock::duration seconds(double value) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(value));
}

/// The organ as the node has it.
core::TriangleMesh askForMesh() {
  const std::string service = "/organ_collision/get_mesh";
  if (!ros::service::waitForService(service, ros::Duration(kPatience)))
    throw std::runtime_error(service + " is not there");
  GetMesh call;
  if (!ros::service::call(service, call) || !call.response.success)
    throw std::runtime_error(service + ": " + call.response.message);
  core::Points positions;
  for (const auto& vertex : call.response.mesh.vertices)
    positions.emplace_back(vertex.x, vertex.y, vertex.z);
  std::vector<core::Corners> triangles;
  for (const auto& triangle : call.response.mesh.triangles) {
    triangles.push_back({core::VertexId(triangle.vertex_indices[0]),
                         core::VertexId(triangle.vertex_indices[1]),
                         core::VertexId(triangle.vertex_indices[2])});
  }
  return {positions, triangles};
}

/// Where each instrument walks [m].
std::vector<core::Points> pathsAround(const core::TriangleMesh& mesh) {
  core::Box box;
  for (const Eigen::Vector3d& position : mesh.positions()) box.add(position);
  const core::CollisionMesh organ(inUnitsOfItsDiagonal(mesh));
  std::vector<core::Points> paths;
  for (std::size_t i = 0; i < kInstruments; ++i) {
    paths.push_back(trajectory(organ, kPathLength, i));
    for (Eigen::Vector3d& tip : paths.back())
      tip = (box.high - box.low).norm() * tip + 0.5 * (box.low + box.high);
  }
  return paths;
}

/// Whole updates for a wave that runs through the organ.
std::vector<MeshUpdate> shapesOf(const core::TriangleMesh& mesh) {
  core::Box box;
  for (const Eigen::Vector3d& position : mesh.positions()) box.add(position);
  const double diagonal = (box.high - box.low).norm();
  std::vector<MeshUpdate> shapes(kShapes);
  for (std::size_t i = 0; i < kShapes; ++i) {
    const double phase = 2.0 * M_PI * static_cast<double>(i) / kShapes;
    shapes[i].header.frame_id = kFrame;
    for (const Eigen::Vector3d& position : mesh.positions()) {
      const double wave = kDent * diagonal * std::sin(20.0 * position.x() / diagonal + phase);
      for (const double coordinate : {position.x(), position.y(), position.z() + wave})
        shapes[i].positions.push_back(static_cast<float>(coordinate));
    }
  }
  return shapes;
}

/// Sends tips and shapes of the organ in a thread each, at steady rates.
class Simulator {
 public:
  /// A step's transforms are sent in so many messages, one right after another.
  Simulator(ros::NodeHandle& node, const core::TriangleMesh& mesh, std::size_t messages)
      : messages_(messages),
        paths_(pathsAround(mesh)),
        shapes_(shapesOf(mesh)),
        tf_(node.advertise<tf2_msgs::TFMessage>("/tf", 100)),
        updates_(node.advertise<MeshUpdate>("/organ_collision/mesh_update", 10)) {}

  bool isHeard() const { return tf_.getNumSubscribers() > 0 && updates_.getNumSubscribers() > 0; }

  /// Returns the stamps sent.
  std::vector<ros::Time> run(double duration, double update_rate) {
    const Clock::time_point start = Clock::now();
    const Clock::time_point end = start + seconds(duration);
    std::thread deforming;
    if (update_rate > 0.0) deforming = std::thread([=] { deform(start, end, update_rate); });
    std::vector<ros::Time> sent;
    for (std::size_t i = 0; Clock::now() < end && ros::ok(); ++i) {
      std::this_thread::sleep_until(start + seconds(static_cast<double>(i) / kRate));
      sent.push_back(sendTips(i));
    }
    if (deforming.joinable()) deforming.join();
    return sent;
  }

 private:
  ros::Time sendTips(std::size_t step) {
    const std::size_t turn = step % (2 * kPathLength);
    const std::size_t place = turn < kPathLength ? turn : 2 * kPathLength - 1 - turn;
    std::vector<tf2_msgs::TFMessage> messages(messages_);
    const ros::Time stamp = ros::Time::now();
    for (std::size_t i = 0; i < kInstruments; ++i) {
      geometry_msgs::TransformStamped transform;
      transform.header.stamp = stamp;
      transform.header.frame_id = kFrame;
      transform.child_frame_id = instrumentName(i);
      const Eigen::Vector3d& tip = paths_[i][place];
      transform.transform.translation.x = tip.x();
      transform.transform.translation.y = tip.y();
      transform.transform.translation.z = tip.z();
      transform.transform.rotation.w = 1.0;
      messages[i % messages_].transforms.push_back(transform);
    }
    for (const tf2_msgs::TFMessage& message : messages) tf_.publish(message);
    return stamp;
  }

  void deform(Clock::time_point start, Clock::time_point end, double rate) {
    for (std::size_t i = 0; Clock::now() < end && ros::ok(); ++i) {
      std::this_thread::sleep_until(start + seconds(static_cast<double>(i) / rate));
      updates_.publish(shapes_[i % kShapes]);
    }
  }

  const std::size_t messages_;
  const std::vector<core::Points> paths_;
  const std::vector<MeshUpdate> shapes_;
  ros::Publisher tf_, updates_;
};

/// What came from the node.
class Listener {
 public:
  explicit Listener(ros::NodeHandle node) : heard_(kInstruments) {
    node.setCallbackQueue(&queue_);
    subscriber_ = node.subscribe("/organ_collision/contacts", 1000, &Listener::take, this,
                                 ros::TransportHints().tcpNoDelay());
    thread_ = std::thread([this] {
      while (!stopping_) queue_.callAvailable(ros::WallDuration(0.01));
    });
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() { stop(); }

  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }

  void stop() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }

  /// [s] from stamp to callback, of an instrument; only when stopped.
  const std::map<ros::Time, double>& heard(std::size_t instrument) const {
    return heard_[instrument];
  }
  /// [s] that the node spent on each cycle's queries, as it says.
  const std::vector<double>& computationTimes() const { return computation_times_; }

 private:
  void take(const ContactArray& array) {
    const ros::Time now = ros::Time::now();
    for (std::size_t i = 0; i < array.contacts.size() && i < kInstruments; ++i) {
      const Contact& contact = array.contacts[i];
      if (contact.status == Contact::OK)
        heard_[i].try_emplace(contact.stamp, (now - contact.stamp).toSec());
    }
    computation_times_.push_back(array.computation_time);
  }

  std::vector<std::map<ros::Time, double>> heard_;  // the first contact of each stamp
  std::vector<double> computation_times_;
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

struct Result {
  std::vector<double> latencies;          // [s] of each tip that was sent; kLost: of a lost one
  std::vector<double> computation_times;  // [s] of a cycle

  std::size_t lost() const {
    return static_cast<std::size_t>(std::count(latencies.begin(), latencies.end(), kLost));
  }
};

Result resultOf(const std::vector<ros::Time>& sent, const Listener& listener) {
  Result result;
  result.computation_times = listener.computationTimes();
  const ros::Time first = sent.front() + ros::Duration(kWarmUp);
  for (const ros::Time& stamp : sent) {
    if (stamp < first) continue;
    for (std::size_t i = 0; i < kInstruments; ++i) {
      const auto heard = listener.heard(i).find(stamp);
      result.latencies.push_back(heard == listener.heard(i).end() ? kLost : heard->second);
    }
  }
  if (result.lost() == result.latencies.size())
    throw std::runtime_error("the node answered nothing");
  return result;
}

Result measure(double duration, double update_rate, std::size_t messages, std::size_t& triangles) {
  ros::NodeHandle node;
  const core::TriangleMesh mesh = askForMesh();
  triangles = mesh.triangleCount();
  Simulator simulator(node, mesh, messages);
  Listener listener(node);
  const Clock::time_point deadline = Clock::now() + seconds(kPatience);
  while (!simulator.isHeard() || !listener.isConnected()) {
    if (Clock::now() > deadline) throw std::runtime_error("the node does not listen");
    std::this_thread::sleep_for(seconds(0.01));
  }
  const std::vector<ros::Time> sent = simulator.run(kWarmUp + duration, update_rate);
  std::this_thread::sleep_for(seconds(kLastContact));
  listener.stop();
  return resultOf(sent, listener);
}

/// Tips by latency: bin i has those up to 10^(i/20) us.
std::string histogram(const std::vector<double>& latencies) {
  constexpr double kBinsPerDecade = 20.0;
  std::map<int, std::size_t> bins;
  for (const double latency : latencies)
    if (latency < kLost)
      ++bins[static_cast<int>(std::ceil(kBinsPerDecade * std::log10(1e6 * latency)))];
  std::string text;
  for (const auto& [bin, count] : bins) {
    text += (text.empty() ? "" : ", ") + std::string("[") +
            tools::significant(std::pow(10.0, bin / kBinsPerDecade), 6) + ", " +
            std::to_string(count) + "]";
  }
  return text;
}

std::string json(const Result& result, std::size_t triangles, std::size_t messages,
                 double update_rate) {
  const auto us = [](const std::vector<double>& times, double share) {
    const double time = tools::percentile(times, share);
    return time < kLost ? tools::significant(1e6 * time, 4) : "null";
  };
  const std::vector<double>& latencies = result.latencies;
  double load = 0.0;  // of the last minute, on all processors
  getloadavg(&load, 1);
  return "{\n  \"triangles\": " + std::to_string(triangles) +
         ",\n  \"instruments\": " + std::to_string(kInstruments) +
         ",\n  \"messages\": " + std::to_string(messages) +
         ",\n  \"rate_hz\": " + tools::significant(kRate) +
         ",\n  \"updates_hz\": " + tools::significant(update_rate) +
         ",\n  \"load\": " + tools::significant(load) +
         ",\n  \"sent\": " + std::to_string(latencies.size()) +
         ",\n  \"lost\": " + std::to_string(result.lost()) +
         ",\n  \"p50_us\": " + us(latencies, 0.5) + ",\n  \"p99_us\": " + us(latencies, 0.99) +
         ",\n  \"p999_us\": " + us(latencies, 0.999) + ",\n  \"max_us\": " + us(latencies, 1.0) +
         ",\n  \"cycle_p50_us\": " + us(result.computation_times, 0.5) +
         ",\n  \"cycle_p99_us\": " + us(result.computation_times, 0.99) +
         ",\n  \"histogram_us\": [" + histogram(latencies) + "]\n}\n";
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--output", "--seconds", "--updates", "--messages"});
  arguments.requireNoWords();
  const std::filesystem::path folder = arguments.option("--output").value_or(".");
  tools::requireWritableFolder(folder);
  const auto updates = static_cast<double>(arguments.whole("--updates", 60));
  std::size_t triangles = 0;
  const std::size_t messages = arguments.whole("--messages", 1, 1, kInstruments);
  const Result result =
      measure(arguments.aboveZero("--seconds", 20.0), updates, messages, triangles);
  const std::string text = json(result, triangles, messages, updates);
  tools::writeFile(folder / "node_latency.json", text);
  std::cout << text << std::flush;
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  ros::init(count, words, "node_latency");
  return tools::runProgram({"node_latency",
                            "usage: node_latency [--output DIR] [--seconds S] [--updates HZ] "
                            "[--messages N]\n"},
                           {words + 1, words + count}, std::cout, std::cerr, bench::run);
}
