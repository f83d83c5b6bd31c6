// SPDX-License-Identifier: BSD-3-Clause
#include "write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <system_error>

namespace rbs {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw std::system_error(errno, std::generic_category(), path);
}

/// A new file beside `path`, open for writing, that is removed unless it takes the name of `path`.
class Draft {
 public:
  explicit Draft(const std::string& path) : path_(path), name_(path + ".XXXXXX") {
    handle_ = mkostemp(name_.data(), O_CLOEXEC);
    if (handle_ < 0) fail(path_);
  }
  ~Draft() {
    if (handle_ >= 0) close(handle_);
    if (!name_.empty()) unlink(name_.c_str());
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  void write(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t count = ::write(handle_, text.data() + done, text.size() - done);
      if (count < 0 && errno != EINTR) fail(path_);
      if (count > 0) done += static_cast<std::size_t>(count);
    }
  }

  void finish() {
    if (fsync(handle_) != 0) fail(path_);
    if (std::rename(name_.c_str(), path_.c_str()) != 0) fail(path_);
    name_.clear();
  }

 private:
  const std::string path_;
  std::string name_;  ///< empty: it has taken the name of path_
  int handle_ = -1;
};

/// A new name is on the disk when its folder is.
void syncFolder(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  const int handle = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  fsync(handle);
  close(handle);
}

}  // namespace

void writeFile(const std::string& path, const std::string& text) {
  Draft draft(path);
  draft.write(text);
  draft.finish();
  syncFolder(path);
}

}  // namespace rbs
