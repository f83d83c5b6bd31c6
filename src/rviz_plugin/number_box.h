// SPDX-License-Identifier: BSD-3-Clause
// NumberBox: a spin box whose numbers have a point, whatever the language of the desktop.
#pragma once

#include <QDoubleSpinBox>
#include <QLabel>
#include <QLineEdit>
#include <QTimer>

#include <optional>

namespace rbs {

/// Shows 1.5 everywhere, and takes 1,5 for it too. QDoubleSpinBox takes a comma for one between thousands, and
/// reads 15. What it does not take it replaces by the last number, and says below itself what that was and what is
/// allowed.
class NumberBox : public QDoubleSpinBox {
 public:
  NumberBox();
  /// Whether it has what has been typed and not entered yet.
  bool isTyping() const { return hasFocus() && lineEdit()->isModified(); }
  /// Enters what has been typed. False where it is refused, or was just before: the refusal is shown, and the next call takes the
  /// number that is in the box.
  bool takeTyped();
  /// Keys that are no part of a number are shortcuts of the window also while it has the focus.
  bool eventFilter(QObject* object, QEvent* event) override;

 protected:
  bool event(QEvent* event) override;
  QValidator::State validate(QString& text, int& position) const override;
  void fixup(QString& text) const override;
  /// Without zeros at the end.
  QString textFromValue(double value) const override;

 private:
  bool isSpecial(const QString& text) const;
  QString withoutSuffix(QString text) const;
  void showRefusal() const;

  mutable std::optional<double> instead_;  ///< in place of what was refused; until that has been read
  QLabel* refusal_;
  QTimer* read_;  ///< until the refusal has been read
};

}  // namespace rbs
