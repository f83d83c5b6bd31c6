// SPDX-License-Identifier: BSD-3-Clause
// BodyProperties: the properties of bodies that are chosen, as a form.
#pragma once

#include "bodies_client.h"
#include "body_fields.h"
#include "value_field.h"

#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QScrollArea>
#include <QTimer>
#include <QToolButton>

#include <functional>
#include <string>
#include <vector>

namespace rbs {

/// A new value is asked for at once for all of them, as one edit. Where the simulator, or the form, refuses it,
/// the reason stands below the field.
class BodyProperties : public QScrollArea {
  Q_OBJECT
 public:
  explicit BodyProperties(BodiesClient& simulator);

  /// The form is about the bodies of these names from now on. `hint` stands in its place where there are none.
  void choose(const QStringList& names, const QString& hint);

  /// Puts the cursor into the name.
  void editName();

 Q_SIGNALS:
  /// A value is entered: what was said before it is about something else.
  void entered();
  /// The form has nothing to show any more, while one of its fields had the focus. It showed what `heading` names.
  void left(const QString& heading);

 private:
  /// A row of the form: a title, one to three editors, and room for a refusal below them.
  struct Row {
    QLabel *title, *note;
    std::vector<ValueField*> fields;
  };

  Row addRow(const QString& name, const QString& unit, const QString& tip, int parts);
  void addNumbers(const BodyField& field);
  void addNote(Row& row);
  void follow();
  /// Those that are chosen.
  void findChosen();
  /// Those that the form shows, as they are by now.
  void findShown();
  bool isTyping() const;
  void show();
  void showNumbers(const BodyField& field, Row& row);
  void note(const Row& row, const QString& refusal);
  void enterNumber(const BodyField& field, Row& row, int part, const QString& text);
  void enterName(const QString& text);
  void chooseKind(int index);
  void chooseColor();
  void showKindAndColor();
  /// Asks for a change to each body that the form shows.
  void ask(const std::function<void(rigid_body_sim::BodyChange&, const KnownBody&)>& write,
           const BodiesClient::Answer& answer);

  BodiesClient& simulator_;
  QStringList chosen_;  ///< names of bodies
  QLabel* hint_;        ///< in place of the form, while there are none
  QWidget* form_;
  QGridLayout* grid_;
  QLabel* heading_;
  Row name_, kind_row_;
  QComboBox* kind_;
  QToolButton* color_;
  std::vector<Row> rows_;             ///< as bodyFields()
  std::vector<KnownBody> bodies_;     ///< those that the form is about
  std::vector<std::uint64_t> shown_;  ///< bodies that the form was last filled with
  std::string shown_scene_;           ///< the scene that they are of
  QTimer refresh_;
};

}  // namespace rbs
