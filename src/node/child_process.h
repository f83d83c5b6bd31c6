// SPDX-License-Identifier: BSD-3-Clause
// A helper program that cannot outlive the node, and whose silence cannot hold it up.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// Owned by the thread that starts it: the system kills the program when that thread ends, however it ends.
class ChildProcess {
 public:
  /// Starts a program; `input` is its standard input. Throws std::system_error where it cannot be run.
  ChildProcess(const std::vector<std::string>& command, const std::string& input);
  /// Kills what still runs and reaps it, so that no zombie stays.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The next line of its standard output, without the line break; empty where none comes in this time, or
  /// the output has ended. Throws std::runtime_error for a line of more than a mebibyte.
  std::optional<std::string> readLine(std::chrono::milliseconds patience);
  /// Whether it has closed its standard output, and all lines have been read.
  bool ended() const { return ended_; }
  /// CPU time that it has taken, s; it does not grow while the program is blocked or stopped.
  double cpuSeconds() const;
  /// Asks it to end, by SIGTERM.
  void terminate();

 private:
  std::optional<std::string> nextLine();

  pid_t pid_ = -1;  ///< also of its process group
  int output_ = -1;
  std::string buffer_;  ///< read, but not yet returned
  bool ended_ = false;
};

}  // namespace rbs
