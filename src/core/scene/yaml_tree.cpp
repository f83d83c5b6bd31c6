// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml_tree.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <sstream>

namespace rbs {
namespace {

constexpr std::size_t kMostProblems = 1000;    // more than anyone reads
constexpr std::size_t kDeepest = 12;           // a scene file nests six deep
constexpr std::size_t kMostKeys = 64;          // a body has about twenty
constexpr std::size_t kMostNodes = 5'000'000;  // up to 950 MB while it is read

/// Throws all problems so far and this one.
[[noreturn]] void refuse(FileProblems& problems, int line, const std::string& path, const std::string& value,
                         const std::string& allowed) {
  problems.add(line, path, value, allowed);
  problems.throwIfAny();
  throw std::logic_error("unreachable");
}

class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(FileProblems& problems) : problems_(problems) {}
  YamlNode takeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    leaf(mark, YamlNode::Kind::Null, "", "null");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { refuseAnchor(mark); }
  void OnAnchor(const YAML::Mark& mark, const std::string&) override { refuseAnchor(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& text) override {
    leaf(mark, YamlNode::Kind::Scalar, tag, text);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark, YamlNode::Kind::Sequence, tag);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open(mark, YamlNode::Kind::Map, tag);
  }
  void OnMapEnd() override { close(); }

 private:
  /// A container whose items are still arriving, and the key of the next one.
  struct Level {
    YamlNode node;
    bool has_key = false;
    int key_line = 0;
    std::string key;
  };

  static int lineOf(const YAML::Mark& mark) { return mark.is_null() ? 1 : mark.line + 1; }

  [[noreturn]] void refuseAnchor(const YAML::Mark& mark) {
    refuse(problems_, lineOf(mark), path(), "an anchor (&) or alias (*)", "the values written out");
  }

  YamlNode makeNode(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& tag) {
    if (++nodes_ > kMostNodes) {
      refuse(problems_, lineOf(mark), path(), "",
             "at most " + std::to_string(kMostNodes) + " values in a file");
    }
    const bool quoted = tag == "!";
    if (!quoted && !tag.empty() && tag != "?") {
      refuse(problems_, lineOf(mark), path(), "the tag " + rbs::quoted(tag), "no tags");
    }
    YamlNode node;
    node.kind = kind;
    node.line = lineOf(mark);
    node.quoted = quoted;
    return node;
  }

  void leaf(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& tag, const std::string& text) {
    YamlNode node = makeNode(mark, kind, tag);
    if (awaitsKey()) {
      takeKey(node.line, text);
    } else {
      node.text = text;
      attach(std::move(node));
    }
  }

  void open(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& tag) {
    if (awaitsKey())
      refuse(problems_, lineOf(mark), path(), "a list or mapping as a key", "a name as the key");
    if (levels_.size() == kDeepest) {
      refuse(problems_, lineOf(mark), "", "", "at most " + std::to_string(kDeepest) + " levels of nesting");
    }
    YamlNode node = makeNode(mark, kind, tag);
    levels_.emplace_back();
    levels_.back().node = std::move(node);
  }

  void close() {
    YamlNode node = std::move(levels_.back().node);
    levels_.pop_back();
    attach(std::move(node));
  }

  bool awaitsKey() const {
    return !levels_.empty() && levels_.back().node.kind == YamlNode::Kind::Map && !levels_.back().has_key;
  }

  void takeKey(int line, const std::string& key) {
    Level& level = levels_.back();
    if (level.node.items.size() == kMostKeys) {
      refuse(problems_, line, path(), "", "at most " + std::to_string(kMostKeys) + " keys in a mapping");
    }
    level.has_key = true;
    level.key_line = line;
    level.key = key;
    if (level.node.find(key)) problems_.add(line, path(), "", "each key once; this one is repeated");
  }

  void attach(YamlNode node) {
    if (levels_.empty()) {
      root_ = std::move(node);
      return;
    }
    Level& level = levels_.back();
    if (level.has_key) {
      node.key = std::move(level.key);
      node.line = level.key_line;
      level.has_key = false;
    }
    level.node.items.push_back(std::move(node));
  }

  std::string path() const {
    std::string path;
    for (const Level& level : levels_) {
      if (level.node.kind == YamlNode::Kind::Sequence) {
        path += "[" + std::to_string(level.node.items.size()) + "]";
      } else if (level.has_key) {
        path += (path.empty() ? "" : ".") + level.key;
      }
    }
    return path;
  }

  FileProblems& problems_;
  std::vector<Level> levels_;
  std::size_t nodes_ = 0;
  YamlNode root_;
};

/// The parser takes some control characters for the end of the text, so none may reach it.
void refuseBinary(const std::string& text, FileProblems& problems) {
  int line = 1;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n') ++line;
    if ((byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7f) {
      refuse(problems, line, "", "the byte " + std::to_string(byte), "text in UTF-8");
    }
  }
}

}  // namespace

const YamlNode* YamlNode::find(const std::string& name) const {
  if (kind != Kind::Map) return nullptr;
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const YamlNode& i) { return i.key == name; });
  return found == items.end() ? nullptr : &*found;
}

void FileProblems::add(int line, const std::string& path, const std::string& value,
                       const std::string& allowed) {
  ++count_;
  if (problems_.size() == kMostProblems) return;
  const std::string place = file_ + ":" + std::to_string(line);
  problems_.push_back({line, {path.empty() ? place : place + ": " + printable(path), value, allowed}});
}

void FileProblems::throwIfAny() const {
  if (problems_.empty()) return;
  auto sorted = problems_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Problem> problems;
  problems.reserve(sorted.size());
  for (auto& [line, problem] : sorted) problems.push_back(std::move(problem));
  throw InvalidInput(std::move(problems));
}

YamlNode parseYaml(const std::string& text, FileProblems& problems) {
  refuseBinary(text, problems);
  std::istringstream stream(text);
  TreeBuilder builder(problems);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    YamlNode root = builder.takeRoot();
    if (parser.HandleNextDocument(builder)) refuse(problems, root.line, "", "two documents", "one document");
    return root;
  } catch (const YAML::Exception& error) {
    refuse(problems, error.mark.is_null() ? 1 : error.mark.line + 1, "", printable(error.msg),
           "well-formed YAML");
  }
}

std::string describe(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::Null:
      return "nothing";
    case YamlNode::Kind::Scalar:
      return quoted(node.text);
    case YamlNode::Kind::Sequence:
      return "a list of " + std::to_string(node.items.size());
    case YamlNode::Kind::Map:
      return "a mapping";
  }
  return "";
}

int lineOf(const YamlNode& root, const std::string& path) {
  const YamlNode* node = &root;
  std::size_t begin = 0;
  while (begin < path.size()) {
    const std::size_t end = std::min(path.find_first_of(".[]", begin), path.size());
    const std::string step = path.substr(begin, end - begin);
    begin = end + 1;
    if (step.empty()) continue;
    if (node->kind == YamlNode::Kind::Sequence && std::isdigit(static_cast<unsigned char>(step[0]))) {
      const std::size_t index = std::stoul(step);
      if (index < node->items.size()) node = &node->items[index];
    } else if (const YamlNode* child = node->find(step)) {
      node = child;
    }
  }
  return node->line;
}

}  // namespace rbs
