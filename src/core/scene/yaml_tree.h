// SPDX-License-Identifier: BSD-3-Clause
// YAML text as a plain tree in which every node knows its line.
//
// Built from the parser's events rather than its node class, for four reasons: a key given twice is
// found, lines are kept, and neither deep nesting nor aliases of aliases can cost more than the text.
#pragma once

#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/types.h"

#include <string>
#include <utility>
#include <vector>

namespace rbs {

struct YamlNode {
  enum class Kind { Null, Scalar, Sequence, Map };
  Kind kind = Kind::Null;
  int line = 1;  ///< of the key for a value of a map, else of the node itself
  bool quoted = false;
  std::string key;              ///< where this is a value of a map
  std::string text;             ///< of a scalar
  std::vector<YamlNode> items;  ///< of a sequence or map

  const YamlNode* find(const std::string& name) const;  ///< value of this key, or null
};

/// The faults of one file, each with its line.
class FileProblems {
 public:
  explicit FileProblems(const std::string& file) : file_(printable(file, kLongestPath)) {}

  void add(int line, const std::string& path, const std::string& value, const std::string& allowed);
  std::size_t count() const { return count_; }
  void throwIfAny() const;  ///< in the order of the lines

 private:
  std::string file_;
  std::size_t count_ = 0;
  std::vector<std::pair<int, Problem>> problems_;  ///< line and fault; the first thousand
};

/// The root of the one document in `text`. A repeated key is added to `problems`. What leaves no tree
/// (a syntax error, an alias, a tag, nesting too deep, too many nodes, bytes that are no text) throws
/// InvalidInput together with them.
YamlNode parseYaml(const std::string& text, FileProblems& problems);

/// A short form of a node for messages: its text, or what it is.
std::string describe(const YamlNode& node);

/// Line of the node at `path` ("bodies[3].size"); names that the tree does not have are passed over.
int lineOf(const YamlNode& root, const std::string& path);

}  // namespace rbs
