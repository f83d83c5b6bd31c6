// SPDX-License-Identifier: BSD-3-Clause
// ValueField: a line for a number or a word that several bodies may have in common.
#pragma once

#include <QLineEdit>

#include <optional>

namespace rbs {

/// Shows a value, or "mixed" where bodies differ. What is typed is given by entered() on Enter or when the
/// focus goes, and stays until show() brings another value; Escape takes it back. A refused text stays too, in
/// the colour of trouble.
class ValueField : public QLineEdit {
  Q_OBJECT
 public:
  ValueField();

  /// Shows a value, or "mixed" where there is none. While something is typed, asked for or refused here it is
  /// kept until later.
  void show(const std::optional<QString>& value);
  /// The answer to what was entered: why it was refused, or an empty text.
  void answer(const QString& refusal);
  /// Shows the value again in place of what was typed or refused.
  void restore();
  /// Whether it has what has been typed and not entered yet.
  bool isTyping() const { return hasFocus() && isModified(); }

 Q_SIGNALS:
  void entered(const QString& text);
  /// What was typed or refused here is gone.
  void restored();

 protected:
  void keyPressEvent(QKeyEvent* event) override;
  /// Undo and redo are those of what is typed here; where nothing is, they are of the simulation.
  bool event(QEvent* event) override;

 private:
  void enter();
  bool isBusy() const { return isModified() || is_asked_ || is_refused_; }
  void put();

  std::optional<QString> value_;
  bool is_asked_ = false, is_refused_ = false;
};

}  // namespace rbs
