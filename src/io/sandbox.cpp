#include "sandbox.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio_ext.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "address_sanitizer.h"
#include "organ_collision/io/message_text.h"

namespace organ_collision::io {
namespace {

using Clock = std::chrono::steady_clock;

constexpr char kResult = 'r';
constexpr char kRefusal = 'e';

// ---- in the child

void lower(decltype(RLIMIT_CPU) resource, rlim_t limit) {
  rlimit now{};
  ::getrlimit(resource, &now);
  now.rlim_cur = now.rlim_max = std::min(limit, now.rlim_max);
  ::setrlimit(resource, &now);
}

/// Allows `more` bytes of address space than are in use.
void limitMemory(std::size_t more) {
  if (kAddressSanitizer) return;  // its shadow memory takes terabytes of addresses
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  lower(RLIMIT_AS, pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more);
}

void limitThisProcess(const ChildLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE, SIGXCPU}) {
    std::signal(signal, SIG_DFL);  // the parent's handlers know nothing of this process
  }
  for (const int signal : {SIGINT, SIGTERM}) {
    std::signal(signal, SIG_IGN);  // Ctrl-C reaches this process too: the parent decides
  }
  std::signal(SIGXFSZ, SIG_IGN);  // what a library says may go to a file: then it is not said
  ::__fpurge(stdout);             // what waits there is the parent's to say
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  lower(RLIMIT_CORE, 0);
  lower(RLIMIT_FSIZE, 0);  // it has nothing to write but to the pipe
  lower(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.seconds)) + 1);
  limitMemory(limits.memory);
}

void writeAll(int pipe, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(pipe, bytes, size);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) ::_exit(1);
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
}

void answer(int pipe, char kind, const std::string& text) {
  writeAll(pipe, &kind, 1);
  writeAll(pipe, text.data(), text.size());
}

[[noreturn]] void runAndExit(int pipe, const std::function<std::string()>& job,
                             const ChildLimits& limits) {
  try {
    limitThisProcess(limits);
    answer(pipe, kResult, job());
  } catch (const std::bad_alloc&) {
    answer(pipe, kRefusal, "needs more than " + std::to_string(limits.memory) + " bytes of memory");
  } catch (const std::exception& error) {
    answer(pipe, kRefusal, error.what());
  } catch (...) {
    answer(pipe, kRefusal, "threw something that is no std::exception");
  }
  ::_exit(0);
}

// ---- in the parent

/// By another part of this program, or by the system, where SIGCHLD is ignored.
constexpr int kTaken = -1;

/// Owns the child and the reading end of its pipe: neither outlives it.
class Child {
 public:
  Child(const std::function<std::string()>& job, const ChildLimits& limits) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
    pid_ = ::fork();
    const int fork_error = errno;
    if (pid_ == 0) runAndExit(ends[1], job, limits);
    ::close(ends[1]);
    pipe_ = ends[0];
    if (pid_ > 0) return;
    ::close(pipe_);
    errno = fork_error;
    fail("fork");
  }
  ~Child() {
    end();
    ::close(pipe_);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  int pipe() const { return pipe_; }

  /// Kills the child if it still runs. Returns its status as of waitpid, or kTaken.
  int end() {
    if (pid_ < 0) return status_;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, &status_, 0) < 0) {
      if (errno == EINTR) continue;
      status_ = kTaken;
      break;
    }
    pid_ = -1;
    return status_;
  }

 private:
  [[noreturn]] static void fail(const char* call) {
    throw std::system_error(errno, std::generic_category(), call);
  }

  pid_t pid_ = -1;
  int pipe_ = -1;
  int status_ = -1;
};

bool waitForBytes(int pipe, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd waited{pipe, POLLIN, 0};
    const int ready = ::poll(&waited, 1, static_cast<int>(std::clamp<long>(left, 0, 60'000)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "poll");
    if (Clock::now() >= deadline) return false;
  }
}

[[noreturn]] void refuse(const std::string& what, const std::string& why) {
  throw std::runtime_error(what + ": " + why);
}

/// All that the child writes until it ends. Throws if that takes too long or is too much.
std::string readAnswer(const std::string& what, int pipe, const ChildLimits& limits) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limits.seconds));
  std::string answer;
  std::array<char, 1 << 16> block{};
  while (answer.size() <= limits.memory) {
    if (!waitForBytes(pipe, deadline)) {
      std::ostringstream seconds;
      seconds << std::setprecision(2) << limits.seconds;
      refuse(what, "took longer than " + seconds.str() + " s");
    }
    const ssize_t count = ::read(pipe, block.data(), block.size());
    if (count < 0 && errno != EINTR)
      throw std::system_error(errno, std::generic_category(), "read");
    if (count == 0) return answer;
    if (count > 0) answer.append(block.data(), static_cast<std::size_t>(count));
  }
  refuse(what, "answered with more than " + std::to_string(limits.memory) + " bytes");
}

std::string ending(int status) {
  if (status == kTaken)
    return "ended, and nobody can say how: this program ignores SIGCHLD, or another part of it "
           "took the exit status";
  if (!WIFSIGNALED(status)) return "ended with exit code " + std::to_string(WEXITSTATUS(status));
  return std::string("the process that reads it crashed: ") + ::strsignal(WTERMSIG(status));
}

}  // namespace

ChildLimits limitsFor(std::uintmax_t size, const LoadLimits& limits) {
  constexpr double kLongest = 1e9;  // [s] which clocks can add
  return {std::min(kLongest,
                   limits.seconds + limits.seconds_per_megabyte * static_cast<double>(size) * 1e-6),
          limits.memory + limits.memory_per_byte * size};
}

std::string runInChild(const std::string& what, const std::function<std::string()>& job,
                       const ChildLimits& limits) {
  Child child(job, limits);
  std::string answer = readAnswer(what, child.pipe(), limits);
  // The pipe is closed by the child's end only, so its status is settled.
  const int status = child.end();
  const bool is_taken = status == kTaken;  // then takeItems() tells whether an answer is whole
  if (status != 0 && (!is_taken || answer.empty())) refuse(what, ending(status));
  const char kind = answer.empty() ? kRefusal : answer.front();
  answer.erase(0, 1);
  if (kind != kResult) refuse(what, printable(answer));
  return answer;
}

}  // namespace organ_collision::io
