#include "node/prompt_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace organ_collision::node {
namespace {

const ros::WallDuration kShort(0.01);
const ros::WallDuration kLong(60.0);
constexpr std::uint64_t kOwner = 1;

struct Called {
  int number;
  std::thread::id thread;
};
using Calls = std::vector<Called>;  // never by two at the same time

class Call : public ros::CallbackInterface {
 public:
  Call(Calls& calls, int number) : calls_(calls), number_(number) {}
  CallResult call() override {
    calls_.push_back({number_, std::this_thread::get_id()});
    return Success;
  }

 private:
  Calls& calls_;
  int number_;
};

/// Brings callbacks, one when the last is called, until it is asked to answer one at once.
class Bringer {
 public:
  explicit Bringer(const std::function<bool(ros::CallbackInterface&)>& answer)
      : queue([this, answer](ros::CallbackInterface& callback) {
          is_asked = true;
          return answer(callback);
        }) {}

  /// In a thread of its own, whose id is returned, while the worker does `work`.
  std::thread::id bringWhile(const std::function<void()>& work) {
    std::thread thread([this] {
      while (!is_asked)
        if (queue.waiting().isEmpty())
          queue.addCallback(boost::make_shared<Call>(calls, brought++), kOwner);
    });
    const std::thread::id id = thread.get_id();
    work();
    thread.join();
    return id;
  }

  Calls calls;
  int brought = 0;
  std::atomic<bool> is_asked{false};
  PromptQueue queue;
};

bool call(ros::CallbackInterface& callback) {
  callback.call();
  return true;
}

TEST(PromptQueue, KeepsWhatComesWhileTheWorkerIsBusy) {
  Bringer bringer(call);
  for (int i = 0; i < 3; ++i)
    bringer.queue.addCallback(boost::make_shared<Call>(bringer.calls, i), kOwner);
  EXPECT_TRUE(bringer.calls.empty());
  bringer.queue.removeByID(kOwner + 1);
  bringer.queue.wait(kLong);  // not at all
  bringer.queue.waiting().callAvailable();
  EXPECT_EQ(bringer.calls.size(), 3U);
  EXPECT_FALSE(bringer.is_asked);
}

TEST(PromptQueue, AnswersAtOnceWhileTheWorkerWaits) {
  Bringer bringer(call);
  const std::thread::id id = bringer.bringWhile([&] {
    while (!bringer.is_asked) {
      bringer.queue.wait(kShort);
      bringer.queue.waiting().callAvailable();
    }
  });
  ASSERT_EQ(static_cast<int>(bringer.calls.size()), bringer.brought);
  for (int i = 0; i < bringer.brought; ++i) {  // in order, and only the last one by the bringer
    EXPECT_EQ(bringer.calls[i].number, i);
    EXPECT_EQ(bringer.calls[i].thread == id, i == bringer.brought - 1);
  }
}

TEST(PromptQueue, WakesTheWorkerForWhatIsNotAnsweredAtOnce) {
  Bringer bringer([](ros::CallbackInterface&) { return false; });
  const ros::SteadyTime start = ros::SteadyTime::now();
  bringer.bringWhile([&] {
    while (!bringer.is_asked) {
      bringer.queue.waiting().callAvailable();
      bringer.queue.wait(kLong);
    }
  });
  EXPECT_LT((ros::SteadyTime::now() - start).toSec(), kLong.toSec());
  bringer.queue.waiting().callAvailable();
  EXPECT_EQ(static_cast<int>(bringer.calls.size()), bringer.brought);
}

TEST(PromptQueue, TellsTheWorkerOfAnError) {
  Bringer bringer([](ros::CallbackInterface&) -> bool { throw std::runtime_error("no memory"); });
  std::string error;
  bringer.bringWhile([&] {
    try {
      while (true) {
        bringer.queue.wait(kLong);
        bringer.queue.waiting().callAvailable();
      }
    } catch (const std::runtime_error& thrown) {
      error = thrown.what();
    }
  });
  EXPECT_EQ(error, "no memory");
}

}  // namespace
}  // namespace organ_collision::node
