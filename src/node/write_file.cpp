// SPDX-License-Identifier: BSD-3-Clause
#include "write_file.h"

#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/types.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>  // renameat2
#include <cstring>
#include <filesystem>

namespace rbs {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuseFile(const std::string& path, const std::string& allowed) {
  throw InvalidInput({{"file", quoted(path, kLongestPath), allowed}});
}

[[noreturn]] void refuseExisting(const std::string& path) {
  refuseFile(path, "a file that is not there yet, or overwrite");
}

[[noreturn]] void failed(const std::string& path) {
  const std::string reason = std::strerror(errno);
  throw InvalidInput({{printable(path, kLongestPath), reason, "a file in a folder that can be written"}});
}

/// An open file, which closes itself.
class OpenFile {
 public:
  OpenFile(int fd, const std::string& path) : fd_(fd) {
    if (fd_ < 0) failed(path);
  }
  ~OpenFile() { ::close(fd_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  operator int() const { return fd_; }

 private:
  int fd_;
};

/// A new file in a folder, with a name that nobody can foresee, which goes when it is not moved away. mkostemp(3) replaces the
/// six X of its name.
class NewFile {
 public:
  explicit NewFile(const fs::path& folder)
      : name_((folder / (".rbs-" + std::string(6, 'X'))).string()),
        fd_(::mkostemp(name_.data(), O_CLOEXEC), folder.string()) {}
  ~NewFile() {
    if (!moved_) ::unlink(name_.c_str());
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  /// On the disk.
  void write(const std::string& text, mode_t mode) {
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = ::write(fd_, text.data() + done, text.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) failed(name_);
      done += static_cast<std::size_t>(n);
    }
    if (::fchmod(fd_, mode) != 0 || ::fsync(fd_) != 0) failed(name_);
  }

  /// Takes the place of `path`; with `overwrite` also where there is a file.
  void moveTo(const std::string& path, bool overwrite) {
    const unsigned flags = overwrite ? 0 : RENAME_NOREPLACE;
    if (::renameat2(AT_FDCWD, name_.c_str(), AT_FDCWD, path.c_str(), flags) != 0)
      errno == EEXIST ? refuseExisting(path) : failed(path);  // somebody else was quicker
    moved_ = true;
  }

 private:
  std::string name_;
  OpenFile fd_;
  bool moved_ = false;
};

}  // namespace

void writeFile(const std::string& path, const std::string& text, bool overwrite) {
  struct stat old {};
  const bool exists = ::lstat(path.c_str(), &old) == 0;
  if (exists && !overwrite) refuseExisting(path);
  if (exists && !S_ISREG(old.st_mode)) refuseFile(path, "a regular file to overwrite");
  const fs::path folder = fs::path(path).parent_path();
  NewFile file(folder);
  file.write(text, exists ? old.st_mode & 0777u : 0644u);
  file.moveTo(path, overwrite);
  const OpenFile parent(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC), folder.string());
  if (::fsync(parent) != 0) failed(folder.string());
}

}  // namespace rbs
