// SPDX-License-Identifier: BSD-3-Clause
#include "resume.h"

#include "words.h"
#include "write_file.h"

#include <ros/console.h>

#include <boost/filesystem.hpp>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace rbs {
namespace {

namespace files = boost::filesystem;

/// The last line of a saved state: a checksum. It detects a file that was cut or changed, which may still be
/// a valid scene.
std::string seal(const std::string& text) {
  std::uint64_t sum = 0xcbf29ce484222325ull;  // FNV-1a
  for (const unsigned char byte : text) sum = (sum ^ byte) * 0x100000001b3ull;
  char line[64];
  std::snprintf(line, sizeof line, "# kept by a node, checksum %016" PRIx64 "\n", sum);
  return line;
}

void checkSeal(const std::string& file) {
  std::string text;
  files::load_string_file(file, text);
  const std::size_t length = seal("").size();
  const std::size_t end = text.size() < length ? 0 : text.size() - length;
  const bool sealed = text.substr(end) == seal(text.substr(0, end));
  if (!sealed)
    throw InvalidInput({{file, "cut or changed since it was saved, or not saved by a node",
                         "a whole state that a node has saved"}});
}

std::string localTime(std::time_t time) {
  char text[32];
  std::tm parts;
  std::strftime(text, sizeof text, "%F %T", localtime_r(&time, &parts));
  return text;
}

}  // namespace

std::string Resume::usualFile(const std::string& node_name) {
  const char* ros_home = std::getenv("ROS_HOME");
  const char* home = std::getenv("HOME");
  const std::string folder = ros_home ? ros_home : std::string(home ? home : "") + "/.ros";
  return folder + "/rigid_body_sim" + node_name + ".yaml";
}

Resume::Resume(Session& session, const std::string& file, bool take) : session_(session), file_(file) {
  boost::system::error_code unreadable;
  untaken_ = files::exists(file_, unreadable);
  if (take) {
    this->take();
  } else if (untaken_) {
    offer();
  }
  const std::shared_ptr<const Snapshot> first = session_.simulator().snapshot();
  first_edits_ = first->edits;
  first_steps_ = first->steps;
}

void Resume::take() {
  if (!untaken_) {
    ROS_WARN_STREAM("no saved session" << (file_.empty() ? ", since ~state_file is none" : " in " + file_)
                                       << ": '" << session_.simulator().snapshot()->scene << "' starts anew");
    return;
  }
  try {
    checkSeal(file_);
    session_.loadState(file_);
    session_.simulator().forgetEdits();  // nobody has seen the world before it
    untaken_ = false;
    const std::shared_ptr<const Snapshot> snapshot = session_.simulator().snapshot();
    ROS_INFO_STREAM("resumed '" << snapshot->scene << "' at " << snapshot->time << " s from " << file_);
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("not resumed: " << error.what() << "; loaded '" << session_.simulator().snapshot()->scene
                                     << "' instead");
  }
}

void Resume::offer() const {
  boost::system::error_code gone;
  ROS_INFO_STREAM("the state of " << localTime(files::last_write_time(file_, gone)) << " is saved in "
                                  << file_ << ": start with resume:=true to continue from it");
}

std::string Resume::previous() const {
  const files::path file(file_);
  return (file.parent_path() / (file.stem().string() + ".previous.yaml")).string();
}

void Resume::keep() {
  if (file_.empty()) return;
  try {
    const auto [world, last] = session_.simulator().copy();
    const bool edited = last->edits != first_edits_;
    if (!edited && (untaken_ || world.steps() == first_steps_)) return;
    const SceneDef scene = world.capture();
    const SavedState state = world.captureState();
    const std::string text = writeScene(scene, state);
    files::create_directories(files::path(file_).parent_path());
    if (untaken_) files::copy_file(file_, previous(), files::copy_options::overwrite_existing);
    writeFile(file_, text + seal(text), true);
    std::printf("saved '%s' at %g s in %s: start with resume:=true to continue from it\n", scene.name.c_str(),
                state.time, file_.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "the state was not saved: %s\n", error.what());
  }
}

}  // namespace rbs
