#include "node/master_watch.h"

#include <ros/connection_manager.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace organ_collision::node {
namespace {

using XmlRpc::XmlRpcValue;

std::string nodeUri() { return ros::XMLRPCManager::instance()->getServerURI(); }

std::string serviceUri() {
  return "rosrpc://" + ros::network::getHost() + ":" +
         std::to_string(ros::ConnectionManager::instance()->getTCPPort());
}

/// The arguments of a call, which begin with the caller's name.
XmlRpcValue arguments(std::initializer_list<XmlRpcValue> rest) {
  XmlRpcValue all;
  int size = 0;
  all[size++] = ros::this_node::getName();
  for (const XmlRpcValue& argument : rest) all[size++] = argument;
  return all;
}

/// What the master answers; nothing if it does not.
std::optional<XmlRpcValue> askMaster(const std::string& method,
                                     std::initializer_list<XmlRpcValue> rest = {}) {
  XmlRpcValue response;
  XmlRpcValue payload;
  if (!ros::master::execute(method, arguments(rest), response, payload, false)) return std::nullopt;
  return payload;
}

/// What roscpp answers in this process, asked from outside: it tells its own topics to nobody else.
XmlRpcValue askSelf(const std::string& method, std::initializer_list<XmlRpcValue> rest = {}) {
  std::string host;
  std::uint32_t port = 0;
  ros::network::splitURI(nodeUri(), host, port);
  XmlRpc::XmlRpcClient self(host.c_str(), static_cast<int>(port), "/");
  XmlRpcValue response;  // [status, message, payload]
  if (!self.execute(method.c_str(), arguments(rest), response) || response.size() != 3)
    throw XmlRpc::XmlRpcException("this node, at " + nodeUri() + ", cannot be reached");
  return response[2];
}

/// The names in `entries`, a list of [name, [nodes]], that this node stands behind.
std::set<std::string> ofThisNode(XmlRpcValue& entries) {
  std::set<std::string> names;
  for (int i = 0; i < entries.size(); ++i) {
    XmlRpcValue& nodes = entries[i][1];
    for (int k = 0; k < nodes.size(); ++k) {
      if (static_cast<std::string>(nodes[k]) != ros::this_node::getName()) continue;
      names.insert(static_cast<std::string>(entries[i][0]));
    }
  }
  return names;
}

struct Topic {
  std::string name, type;
};

/// Those of `topics`, a list of [name, type], that are not `known`.
std::vector<Topic> missing(XmlRpcValue topics, const std::set<std::string>& known) {
  std::vector<Topic> result;
  for (int i = 0; i < topics.size(); ++i) {
    const Topic topic = {topics[i][0], topics[i][1]};
    if (known.count(topic.name) == 0) result.push_back(topic);
  }
  return result;
}

std::vector<std::string> missing(const std::set<std::string>& services,
                                 const std::set<std::string>& known) {
  std::vector<std::string> result;
  std::set_difference(services.begin(), services.end(), known.begin(), known.end(),
                      std::back_inserter(result));
  return result;
}

void publish(const Topic& topic) {
  askMaster("registerPublisher", {topic.name, topic.type, nodeUri()});
}

void subscribe(const Topic& topic) {
  const std::optional<XmlRpcValue> publishers =
      askMaster("registerSubscriber", {topic.name, topic.type, nodeUri()});
  // An empty list would cut the connections to those whom the master has forgotten too.
  if (publishers && publishers->size() > 0) askSelf("publisherUpdate", {topic.name, *publishers});
}

void serve(const std::string& service) {
  askMaster("registerService", {service, serviceUri(), nodeUri()});
}

}  // namespace

void MasterWatch::check() {
  asks_since_ = ros::SteadyTime::now().toSec();
  try {
    registerMissing();
  } catch (const XmlRpc::XmlRpcException& error) {  // no std::exception, and no reason to end
    log_.warn("whether the master knows this node is not known: " + error.getMessage());
  }
  asks_since_ = 0.0;
}

std::string MasterWatch::complaint() const {
  constexpr double kPatience = 3.0;  // [s]
  const double since = asks_since_;
  const double waits = since > 0.0 ? ros::SteadyTime::now().toSec() - since : 0.0;
  if (!is_away_ && waits < kPatience) return "";
  const std::string how_long = is_away_ ? "" : " for " + std::to_string(waits) + " s";
  return "the master does not answer" + how_long +
         ": who is connected stays so, nobody new finds this node";
}

void MasterWatch::registerMissing() {
  std::optional<XmlRpcValue> state = askMaster("getSystemState");
  is_away_ = !state;
  if (!state) return;

  const std::vector<Topic> publications =
      missing(askSelf("getPublications"), ofThisNode((*state)[0]));
  const std::vector<Topic> subscriptions =
      missing(askSelf("getSubscriptions"), ofThisNode((*state)[1]));
  const std::set<std::string> known = ofThisNode((*state)[2]);
  services_.insert(known.begin(), known.end());
  const std::vector<std::string> services = missing(services_, known);
  if (ros::isShuttingDown()) return;  // it unregisters, and that is no forgetting
  const std::size_t count = publications.size() + subscriptions.size() + services.size();
  if (count == 0) return;
  // Another node of this name may have come: then all is that one's, and this one is told to end.
  const std::optional<XmlRpcValue> holder = askMaster("lookupNode", {ros::this_node::getName()});
  if (holder && *holder != XmlRpcValue(nodeUri())) {
    log_.warn("the master knows another node of this name, which this one leaves it to");
    return;
  }
  log_.warn("the master does not know " + std::to_string(count) +
            " topics and services of this node: registered anew");
  std::for_each(publications.begin(), publications.end(), publish);
  std::for_each(subscriptions.begin(), subscriptions.end(), subscribe);
  std::for_each(services.begin(), services.end(), serve);
}

}  // namespace organ_collision::node
