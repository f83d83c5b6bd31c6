// SPDX-License-Identifier: BSD-3-Clause
#include "child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

namespace rbs {
namespace {

constexpr std::size_t kLongestLine = 1 << 20;

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {
    if (number < 0) fail("no file descriptor");
  }
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  int number() const { return number_; }
  int release() { return std::exchange(number_, -1); }
  void close() {
    if (number_ >= 0) ::close(release());
  }

 private:
  int number_;
};

struct Pipe {
  Descriptor read, write;
  static Pipe open() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) fail("no pipe");
    return {Descriptor(ends[0]), Descriptor(ends[1])};
  }
};

/// A file without a name, which is gone with the last process that has it open.
Descriptor fileOf(const std::string& text) {
  Descriptor file(memfd_create("input", MFD_CLOEXEC));
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = write(file.number(), text.data() + done, text.size() - done);
    if (n < 0) fail("cannot hold the input");
    done += static_cast<std::size_t>(n);
  }
  lseek(file.number(), 0, SEEK_SET);
  return file;
}

// In the process to be. Only calls that are safe after a fork of a process with threads.
[[noreturn]] void becomeProgram(char* const* arguments, pid_t parent, int input, int output, int report) {
  setpgid(0, 0);  // a Ctrl-C of the terminal is for the node
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent ended before prctl() took effect
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);  // the threads of ROS block all signals
  std::signal(SIGPIPE, SIG_DFL);
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);  // the sockets of ROS are not for others
  execv(arguments[0], arguments);
  const int reason = errno;
  [[maybe_unused]] const ssize_t written = write(report, &reason, sizeof reason);
  _exit(127);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const std::string& input) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const Descriptor file = fileOf(input);
  Pipe output = Pipe::open(), report = Pipe::open();
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) fail("no process");
  if (pid_ == 0)
    becomeProgram(arguments.data(), parent, file.number(), output.write.number(), report.write.number());
  report.write.close();
  int reason = 0;
  if (read(report.read.number(), &reason, sizeof reason) == sizeof reason) {
    waitpid(pid_, nullptr, 0);
    throw std::system_error(reason, std::generic_category(), command[0]);
  }
  output_ = output.read.release();
}

ChildProcess::~ChildProcess() {
  using namespace std::chrono_literals;
  kill(-pid_, SIGKILL);
  close(output_);
  // A process in an uninterruptible wait of the kernel ends only after it: not waited for.
  for (int k = 0; k < 100 && waitpid(pid_, nullptr, WNOHANG) == 0; ++k) std::this_thread::sleep_for(10ms);
}

std::optional<std::string> ChildProcess::readLine(std::chrono::milliseconds patience) {
  if (std::optional<std::string> line = nextLine()) return line;
  pollfd ready{output_, POLLIN, 0};
  if (poll(&ready, 1, static_cast<int>(patience.count())) <= 0) return std::nullopt;
  char text[4096];
  const ssize_t n = read(output_, text, sizeof text);
  if (n < 0 && errno == EINTR) return std::nullopt;
  ended_ = n <= 0;
  if (n > 0) buffer_.append(text, static_cast<std::size_t>(n));
  if (buffer_.size() > kLongestLine) throw std::runtime_error("a line of more than a mebibyte");
  return nextLine();
}

std::optional<std::string> ChildProcess::nextLine() {
  const std::size_t end = buffer_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

double ChildProcess::cpuSeconds() const {
  clockid_t clock;
  timespec time{};
  if (clock_getcpuclockid(pid_, &clock) == 0) clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void ChildProcess::terminate() {
  kill(-pid_, SIGTERM);
}

}  // namespace rbs
