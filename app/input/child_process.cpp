// SPDX-License-Identifier: Apache-2.0
#include "app/input/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "sunder/error.hpp"

namespace sunder::app {
namespace {

constexpr int kDone = 0;
constexpr int kOutOfMemory = 3;
constexpr int kFailed = 4;

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      throw Error(1, std::string("cannot make a pipe: ") + std::strerror(errno));
    read = ends[0];
    write = ends[1];
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(read);
    close_end(write);
  }
  static void close_end(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }
};

// RLIMIT_DATA counts private writable memory, what the parent held at the fork included.
void limit_memory(std::size_t bytes) {
  if (!kLimitsMemory) return;
  std::ifstream statm("/proc/self/statm");
  std::size_t size = 0, resident = 0, shared = 0, text = 0, lib = 0, data = 0;
  statm >> size >> resident >> shared >> text >> lib >> data;
  const std::size_t held = data * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const rlimit limit{held + bytes, held + bytes};
  ::setrlimit(RLIMIT_DATA, &limit);
}

void write_all(int file, const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(kFailed);
    done += static_cast<std::size_t>(written);
  }
}

[[noreturn]] void be_child(const std::function<std::string()>& work, const ChildLimits& limits,
                           Pipe& result, Pipe& errors, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(kFailed);  // it was gone before
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL})
    ::signal(signal, SIG_DFL);
  sigset_t none;  // the parent may hold some back
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int null = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  ::dup2(null, STDOUT_FILENO);
  ::dup2(errors.write, STDERR_FILENO);
  limit_memory(limits.memory_bytes);
  try {
    write_all(result.write, work());
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
    ::_exit(kFailed);
  }
  ::_exit(kDone);  // no destructors, no exit handlers: they are the parent's
}

// Appends what is there; closes the end at its end of file.
void drain(int& file, std::string& text, std::size_t keep_last) {
  std::array<char, 65536> buffer{};
  const ssize_t count = ::read(file, buffer.data(), buffer.size());
  if (count < 0 && (errno == EINTR || errno == EAGAIN)) return;
  if (count <= 0) {
    Pipe::close_end(file);
    return;
  }
  text.append(buffer.data(), static_cast<std::size_t>(count));
  if (text.size() > 2 * keep_last) text.erase(0, text.size() - keep_last);
}

// Reads both pipes to their ends; false when the time is over first.
bool collect(Pipe& result, Pipe& errors, ChildOutcome& outcome,
             std::chrono::steady_clock::time_point deadline) {
  constexpr std::size_t kKeepErrors = 16384;
  constexpr std::size_t kKeepResult = static_cast<std::size_t>(-1) / 4;
  while (result.read >= 0 || errors.read >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    std::array<pollfd, 2> files = {pollfd{result.read, POLLIN, 0}, pollfd{errors.read, POLLIN, 0}};
    ::poll(files.data(), files.size(), static_cast<int>(std::min<long long>(left.count(), 1000)));
    if (files[0].revents != 0) drain(result.read, outcome.result, kKeepResult);
    if (files[1].revents != 0) drain(errors.read, outcome.error_text, kKeepErrors);
  }
  return true;
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

const bool kLimitsMemory =
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
    false;
#else
    true;
#endif
#else
    true;
#endif

ChildOutcome run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  using End = ChildOutcome::End;
  Pipe result, errors;
  const auto deadline = std::chrono::steady_clock::now() + limits.timeout;
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throw Error(1, std::string("cannot start a process: ") + std::strerror(errno));
  if (child == 0) be_child(work, limits, result, errors, parent);
  Pipe::close_end(result.write);
  Pipe::close_end(errors.write);

  ChildOutcome outcome;
  const bool in_time = collect(result, errors, outcome, deadline);
  if (!in_time) ::kill(child, SIGKILL);
  const int status = wait_for(child);
  if (!in_time) {
    outcome.end = End::timed_out;
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kDone) {
    outcome.end = End::done;
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory) {
    outcome.end = End::out_of_memory;
  } else {
    outcome.end = End::crashed;
    outcome.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }
  return outcome;
}

}  // namespace sunder::app
