// SPDX-License-Identifier: BSD-3-Clause
#include "parameters.h"

#include "nearest.h"
#include "words.h"

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

using Value = XmlRpc::XmlRpcValue;

/// "'abc'", "true", "3": a text of someone else, cut where it is too long for a message.
std::string shown(Value value) {
  constexpr std::size_t kLongest = 80;
  if (value.getType() == Value::TypeBoolean) return static_cast<bool>(value) ? "true" : "false";
  const bool is_text = value.getType() == Value::TypeString;
  std::string text = is_text ? static_cast<std::string>(value) : value.toXml();
  if (value.getType() == Value::TypeInt) text = std::to_string(static_cast<int>(value));
  if (value.getType() == Value::TypeDouble) text = words(static_cast<double>(value));
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return is_text ? "'" + text + "'" : text;
}

std::string oneOf(const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k)
    list += (k == 0 ? "" : k + 1 < names.size() ? ", " : " or ") + (names[k].empty() ? "''" : names[k]);
  return list;
}

}  // namespace

Parameters::Parameters(Value given) {
  if (given.getType() != Value::TypeStruct) return;
  for (auto& [name, value] : given) given_[name] = value;
}

Value* Parameters::find(const std::string& name, const std::string& usual, const std::string& help) {
  entries_.push_back({name, usual, help});
  const auto found = given_.find(name);
  return found == given_.end() ? nullptr : &found->second;
}

void Parameters::refuse(const std::string& name, const Value& value, const std::string& allowed) {
  problems_.push_back({"~" + name, shown(value), allowed});
}

std::string Parameters::text(const std::string& name, const std::string& usual, const std::string& help) {
  Value* value = find(name, usual, help);
  if (!value) return usual;
  if (value->getType() == Value::TypeString) return *value;
  refuse(name, *value, "a text");
  return usual;
}

bool Parameters::flag(const std::string& name, bool usual, const std::string& help) {
  Value* value = find(name, usual ? "true" : "false", help);
  if (!value) return usual;
  if (value->getType() == Value::TypeBoolean) return *value;
  refuse(name, *value, "true or false");
  return usual;
}

double Parameters::number(const std::string& name, double usual, double least, double most,
                          const std::string& help) {
  Value* value = find(name, words(usual), help);
  if (!value) return usual;
  const bool whole = value->getType() == Value::TypeInt;
  if (whole || value->getType() == Value::TypeDouble) {
    const double given = whole ? static_cast<int>(*value) : static_cast<double>(*value);
    if (given >= least && given <= most) return given;  // which NaN is not
  }
  refuse(name, *value, words("a number from ", least, " to ", most));
  return usual;
}

int Parameters::integer(const std::string& name, int usual, int least, int most, const std::string& help) {
  Value* value = find(name, std::to_string(usual), help);
  if (!value) return usual;
  if (value->getType() == Value::TypeInt) {
    const int given = *value;
    if (given >= least && given <= most) return given;
  }
  refuse(name, *value, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return usual;
}

std::string Parameters::choice(const std::string& name, const std::string& usual,
                               const std::vector<std::string>& allowed, const std::string& help) {
  Value* value = find(name, usual, help + ": " + oneOf(allowed));
  if (!value) return usual;
  if (value->getType() == Value::TypeString) {
    const std::string given = *value;
    if (std::find(allowed.begin(), allowed.end(), given) != allowed.end()) return given;
  }
  refuse(name, *value, oneOf(allowed));
  return usual;
}

void Parameters::check() const {
  if (!problems_.empty()) throw InvalidInput(problems_);
}

std::vector<std::string> Parameters::unknown() const {
  std::vector<std::string> known;
  for (const Entry& entry : entries_) known.push_back(entry.name);
  std::vector<std::string> sentences;
  for (const auto& [name, value] : given_) {
    if (value.getType() == Value::TypeStruct) continue;  // a namespace: parameters of someone else
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string nearest = nearestName(name, known);
    sentences.push_back("unknown parameter ~" + name + " (" + shown(value) + ") has no effect; " +
                        (nearest.empty() ? "parameters: " + oneOf(known) : "did you mean ~" + nearest + "?"));
  }
  return sentences;
}

std::string Parameters::list() const {
  std::size_t longest = 0;
  for (const Entry& entry : entries_) longest = std::max(longest, entry.name.size());
  std::string lines;
  for (const Entry& entry : entries_) {
    const std::string usual = entry.usual.empty() ? "''" : entry.usual;
    lines += "  ~" + entry.name + std::string(longest + 2 - entry.name.size(), ' ') + entry.help + " (" +
             usual + ")\n";
  }
  return lines;
}

}  // namespace rbs
