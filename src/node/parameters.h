// SPDX-License-Identifier: BSD-3-Clause
// The private parameters of the node: each is read once, by name, with its type and range.
#pragma once

#include "rigid_body_sim/types.h"

#include <XmlRpcValue.h>

#include <map>
#include <string>
#include <vector>

namespace rbs {

/// Reading a parameter says all there is to say of it, so that the list for `--help` and the names that are
/// known come of the reading. Faults are gathered until check().
class Parameters {
 public:
  /// `given`: values by name, as the parameter server holds them; not a struct means none.
  explicit Parameters(XmlRpc::XmlRpcValue given = {});

  /// Each returns the value given, or `usual` where none is given or it is not allowed. `help` says what it
  /// does.
  std::string text(const std::string& name, const std::string& usual, const std::string& help);
  bool flag(const std::string& name, bool usual, const std::string& help);
  double number(const std::string& name, double usual, double least, double most, const std::string& help);
  int integer(const std::string& name, int usual, int least, int most, const std::string& help);
  std::string choice(const std::string& name, const std::string& usual,
                     const std::vector<std::string>& allowed, const std::string& help);

  /// Adds a fault that the reading does not see: the value of `name` is not one that is `allowed`.
  void refuse(const std::string& name, const XmlRpc::XmlRpcValue& value, const std::string& allowed);

  /// Throws InvalidInput with every fault: the parameter, its value and what is allowed.
  void check() const;
  /// A sentence for each parameter that is given and was not read, with the name that was probably meant.
  std::vector<std::string> unknown() const;
  /// A line for each parameter that was read: name, usual value, what it does.
  std::string list() const;

 private:
  struct Entry {
    std::string name, usual, help;
  };

  XmlRpc::XmlRpcValue* find(const std::string& name, const std::string& usual, const std::string& help);

  std::map<std::string, XmlRpc::XmlRpcValue> given_;
  std::vector<Entry> entries_;
  std::vector<Problem> problems_;
};

}  // namespace rbs
