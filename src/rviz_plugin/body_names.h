// SPDX-License-Identifier: BSD-3-Clause
// Lists of body names, as messages and as Qt have them.
#pragma once

#include <QSet>
#include <QString>
#include <QStringList>

#include <string>
#include <vector>

namespace rbs {

inline std::vector<std::string> toStd(const QStringList& names) {
  std::vector<std::string> list;
  for (const QString& name : names) list.push_back(name.toStdString());
  return list;
}

inline QStringList toQt(const std::vector<std::string>& names) {
  QStringList list;
  for (const std::string& name : names) list.append(QString::fromStdString(name));
  return list;
}

inline QSet<QString> toSet(const QStringList& names) {
  QSet<QString> set;
  for (const QString& name : names) set.insert(name);
  return set;
}

}  // namespace rbs
