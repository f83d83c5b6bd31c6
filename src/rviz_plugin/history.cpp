// SPDX-License-Identifier: BSD-3-Clause
#include "history.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace rbs {
namespace {

constexpr std::size_t kMarks = 500;
constexpr std::size_t kTogether = 8;  // lines of a mark

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

// Made of digits by hand: the locale of a Qt program may write a comma for the decimal point.
std::string textOf(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  std::replace(text, text + sizeof text, ',', '.');
  return text;
}

}  // namespace

void History::add(const std::string& curve, const Sample& sample) {
  present_[curve].add(sample);
  end_ = std::max(end_, sample.time);
}

void History::mark(double time, const std::string& text) {
  if (marks_.empty() || marks_.back().time != time) {
    marks_.push_back({time, text});
    marked_together_ = 1;
    if (marks_.size() > kMarks) marks_.pop_front();
    return;
  }
  ++marked_together_;
  if (marked_together_ <= kTogether) marks_.back().text += "\n" + text;
  if (marked_together_ == kTogether + 1) marks_.back().text += "\nand more";
}

void History::beginRun() {
  before_ = std::exchange(present_, {});
  marks_.clear();
  end_ = 0.0;
  ++run_;
}

void History::forget(const std::string& curve) {
  present_.erase(curve);
  before_.erase(curve);
}

void History::rename(const CurveNames& new_names) {
  for (Traces* const traces : {&present_, &before_}) renameKeys(*traces, new_names);
}

const Trace& History::find(const Traces& traces, const std::string& curve) {
  static const Trace kNone;
  const auto it = traces.find(curve);
  return it == traces.end() ? kNone : it->second;
}

const Trace& History::present(const std::string& curve) const {
  return find(present_, curve);
}

const Trace& History::before(const std::string& curve) const {
  return find(before_, curve);
}

std::string csvOf(const std::vector<Column>& columns) {
  std::map<double, std::vector<std::string>> rows;
  std::string text = "time (s)";
  for (std::size_t k = 0; k < columns.size(); ++k) {
    text += "," + csvField(columns[k].heading);
    for (const Sample& sample : columns[k].samples) {
      std::vector<std::string>& row = rows[sample.time];
      row.resize(columns.size());
      row[k] = textOf(sample.value);
    }
  }
  text += "\r\n";
  for (const auto& [time, cells] : rows) {
    text += textOf(time);
    for (const std::string& cell : cells) text += "," + cell;
    text += "\r\n";
  }
  return text;
}

}  // namespace rbs
