#include "io/sandbox.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <locale>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "io/address_sanitizer.h"
#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr ChildLimits kLimits{5.0, 100'000'000};
constexpr double kMuchLater =
    4.0;  // [s] far above what a stopped child takes, also on a busy machine

std::string run(const std::function<std::string()>& job, const ChildLimits& limits = kLimits) {
  return runInChild("the job", job, limits);
}

double secondsOf(const std::function<void()>& action) {
  const auto begin = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::ptrdiff_t openFiles() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return std::distance(begin(files), end(files));
}

/// Those that a program started by this process would have too.
std::size_t inheritedFiles() {
  std::size_t count = 0;
  for (const auto& file : std::filesystem::directory_iterator("/proc/self/fd")) {
    const int flags = ::fcntl(std::stoi(file.path().filename()), F_GETFD);
    if (flags >= 0 && (flags & FD_CLOEXEC) == 0) ++count;
  }
  return count;
}

[[noreturn]] void sleepForever() {
  for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

TEST(Sandbox, LeavesNoCore) {
  const auto limit = [] {
    rlimit core{};
    ::getrlimit(RLIMIT_CORE, &core);
    return core;
  };
  const rlimit before = limit();
  if (before.rlim_max == 0) GTEST_SKIP() << "nobody may leave one here";
  const rlimit raised = {before.rlim_max, before.rlim_max};
  ::setrlimit(RLIMIT_CORE, &raised);
  EXPECT_EQ(run([&] { return std::to_string(limit().rlim_cur); }), "0");
  ::setrlimit(RLIMIT_CORE, &before);
}

TEST(Sandbox, EndsWithItsParent) {
  EXPECT_EQ(run([] {
              int signal = 0;
              ::prctl(PR_GET_PDEATHSIG, &signal);
              return std::to_string(signal);
            }),
            std::to_string(SIGKILL));
}

TEST(Sandbox, HearsSignalsThatItsParentBlocks) {
  sigset_t one, before;
  sigemptyset(&one);
  sigaddset(&one, SIGUSR1);
  ::pthread_sigmask(SIG_BLOCK, &one, &before);
  EXPECT_THROW(run([] {
                 ::raise(SIGUSR1);
                 return std::string();
               }),
               std::runtime_error);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST(Sandbox, ItsPipeIsClosedInProgramsThatAreStartedMeanwhile) {
  EXPECT_EQ(run([] { return std::to_string(inheritedFiles()); }), std::to_string(inheritedFiles()));
}

TEST(Sandbox, ReturnsEveryByteOfTheResult) {
  std::string bytes(5'000'000, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
  EXPECT_EQ(run([&] { return bytes; }), bytes);
  EXPECT_EQ(run([] { return std::string(); }), "");
}

TEST(Sandbox, PassesTheMessageOfAnExceptionOn) {
  const auto job = []() -> std::string { throw std::out_of_range("vertex 7 of 3"); };
  EXPECT_EQ(messageOf([&] { run(job); }), "the job: vertex 7 of 3");
  const auto odd_job = []() -> std::string { throw 7; };
  EXPECT_THAT(messageOf([&] { run(odd_job); }), HasSubstr("no std::exception"));
}

TEST(Sandbox, SurvivesACrash) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGKILL}) {
    const auto job = [signal]() -> std::string {
      std::raise(signal);
      return "alive";
    };
    EXPECT_EQ(messageOf([&] { run(job); }),
              std::string("the job: the process that reads it crashed: ") + strsignal(signal));
  }
}

TEST(Sandbox, SaysThatTheChildLeftWithoutAnAnswer) {
  const auto job = []() -> std::string { ::_exit(3); };
  EXPECT_EQ(messageOf([&] { run(job); }), "the job: ended with exit code 3");
  const auto leaves_quietly = []() -> std::string { ::_exit(0); };
  EXPECT_THROW(run(leaves_quietly), std::runtime_error);
}

TEST(Sandbox, EndsAHangAtTheLimit) {
  const auto job = []() -> std::string { sleepForever(); };
  std::string message;
  const double seconds = secondsOf([&] {
    message = messageOf([&] { run(job, {0.1, 1'000'000}); });
  });
  EXPECT_EQ(message, "the job: took longer than 0.1 s");
  EXPECT_GE(seconds, 0.1);
  EXPECT_LT(seconds, kMuchLater);
}

TEST(Sandbox, EndsAHangThatIgnoresSignals) {
  const auto job = []() -> std::string {
    std::signal(SIGTERM, SIG_IGN);
    std::signal(SIGINT, SIG_IGN);
    sleepForever();
  };
  EXPECT_LT(secondsOf([&] { messageOf([&] { run(job, {0.1, 1'000'000}); }); }), kMuchLater);
}

TEST(Sandbox, RefusesAHungryJob) {
  if (kAddressSanitizer)
    GTEST_SKIP() << "the address sanitizer needs all addresses: there is no memory limit under it";
  const auto job = [] {
    std::vector<std::string> blocks;
    while (blocks.size() < 1000) blocks.emplace_back(1'000'000, 'x');
    return std::string("fed");
  };
  EXPECT_EQ(messageOf([&] { run(job); }), "the job: needs more than 100000000 bytes of memory");
}

TEST(Sandbox, RefusesALongAnswer) {
  const auto job = [] { return std::string(3'000'000, 'x'); };
  EXPECT_THAT(messageOf([&] {
                run(job, {5.0, 2'000'000});
              }),
              AnyOf("the job: needs more than 2000000 bytes of memory",
                    "the job: answered with more than 2000000 bytes"));
}

TEST(Sandbox, LeavesNoProcessAndNoFileBehind) {
  const std::ptrdiff_t before = openFiles();
  run([] { return std::string("result"); });
  messageOf([] { run([]() -> std::string { std::abort(); }); });
  messageOf([] { run([]() -> std::string { sleepForever(); }, {0.05, 1'000'000}); });
  EXPECT_EQ(openFiles(), before);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a child is left";
}

TEST(Sandbox, AnswersWhereNobodyCaresForChildren) {
  const auto former = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(run([] { return std::string("result"); }), "result");
  EXPECT_THAT(messageOf([] { run([]() -> std::string { std::abort(); }); }),
              HasSubstr("ended, and nobody can say how"));
  std::signal(SIGCHLD, former);
}

TEST(Sandbox, WaitsForeverIfItIsToldTo) {
  constexpr double kForever = std::numeric_limits<double>::infinity();
  const ChildLimits limits = limitsFor(1, {kForever, kForever});
  EXPECT_LE(limits.seconds, 1e9);  // clocks cannot add more
  EXPECT_EQ(run([] { return std::string("result"); }, limits), "result");
}

TEST(Sandbox, IsLeftAloneByTheSignalsThatEndAProgram) {
  for (const int signal : {SIGINT, SIGTERM}) {  // Ctrl-C reaches parent and child
    const auto job = [signal] {
      std::raise(signal);
      return std::string("alive");
    };
    EXPECT_EQ(run(job), "alive") << signal;
  }
}

TEST(Sandbox, WritesNoFile) {
  const TemporaryFolder folder;
  const auto job = [&] {
    folder.write("file", "x");
    return std::string("written");
  };
  EXPECT_NE(messageOf([&] { run(job); }), "");
  EXPECT_EQ(std::filesystem::file_size(folder.path() / "file"), 0U);
}

/// As a node's are that is started with its output in a file, or in a pipe.
TEST(Sandbox, BearsWhateverItsOutputGoesTo) {
  const TemporaryFolder folder;
  const std::string log = folder.write("log", "");
  std::fflush(stdout);
  const int output = ::dup(STDOUT_FILENO);
  const int errors = ::dup(STDERR_FILENO);
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const int file = ::open(log.c_str(), O_WRONLY | O_APPEND);
  ::dup2(pipe[1], STDOUT_FILENO);
  ::dup2(file, STDERR_FILENO);
  std::fputs("once", stdout);  // waits in this process
  const std::string message = messageOf([] {
    EXPECT_EQ(run([] {
                std::cerr << "a library complains" << std::endl;
                std::fflush(stdout);
                return std::string("done");
              }),
              "done");
  });
  std::fflush(stdout);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  for (const int descriptor : {output, errors, file, pipe[1]}) ::close(descriptor);
  std::string heard(100, ' ');
  heard.resize(
      static_cast<std::size_t>(std::max<ssize_t>(0, ::read(pipe[0], heard.data(), heard.size()))));
  ::close(pipe[0]);
  EXPECT_EQ(message, "");
  EXPECT_EQ(heard, "once");
}

/// A lock that another thread holds at the fork stays locked in the child. The C library takes care
/// of its own (memory, streams), and a reader takes no others.
TEST(Sandbox, DoesNotHangOnLocksOfOtherThreads) {
  if (kAddressSanitizer)
    GTEST_SKIP() << "the address sanitizer's allocator has locks that fork() does not take care of";
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&stop] {
      while (!stop) {
        const std::vector<std::string> blocks(100, std::string(1000, 'x'));
        std::ofstream("/dev/null") << blocks.size() << std::locale().name();
        std::fflush(nullptr);
      }
    });
  }
  const auto job = [] {
    std::ostringstream text;
    for (const std::string& block : std::vector<std::string>(100, "y")) text << block << 0.5;
    return text.str();
  };
  int hung = 0;
  for (std::size_t i = 0; i < roundCount(300); ++i) {
    hung += messageOf([&] { run(job, {2.0, 100'000'000}); }).empty() ? 0 : 1;
  }
  stop = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(hung, 0);
}

TEST(Sandbox, WorksWithWhateverSignalHandlersTheParentHas) {
  const auto former = std::signal(SIGSEGV, SIG_IGN);
  const auto job = []() -> std::string {
    std::raise(SIGSEGV);
    return "alive";
  };
  EXPECT_THAT(messageOf([&] { run(job); }),
              StartsWith("the job: the process that reads it crashed"));
  std::signal(SIGSEGV, former);
}

}  // namespace
}  // namespace organ_collision::io
