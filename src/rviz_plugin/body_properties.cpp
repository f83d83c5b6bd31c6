// SPDX-License-Identifier: BSD-3-Clause
#include "body_properties.h"

#include "colors.h"
#include "hinted_box.h"
#include "wheel_guard.h"

#include <QAbstractItemView>
#include <QApplication>
#include <QColorDialog>
#include <QRegularExpression>
#include <QTimer>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace rbs {
namespace {

constexpr int kColumns = 4;        // a title, and three parts
constexpr int kRefreshTime = 100;  // ms from a motion until it is shown

// What stands in a field: the text that all bodies have in common that have the property; empty where they
// differ.
template <class Read>
std::optional<QString> commonText(const std::vector<KnownBody>& bodies, Read read) {
  std::optional<QString> common;
  for (const KnownBody& body : bodies) {
    const std::optional<QString> text = read(body);
    if (!text) continue;
    if (common && *common != *text) return std::nullopt;
    common = text;
  }
  return common;
}

// "changes[0] ('box_1').material.friction: -1; ..." is about a field that the reader has before him.
QString withoutPlace(const QString& refusal) {
  static const QRegularExpression place(R"(^changes\[\d+\] \('([^']*)'\)[^:]*: )");
  const QRegularExpressionMatch match = place.match(refusal);
  return match.hasMatch() ? refusal.mid(match.capturedEnd()) : refusal;
}

QIcon swatch(const QColor& color, int size) {
  QPixmap picture(size, size);
  picture.fill(color);
  return QIcon(picture);
}

}  // namespace

BodyProperties::BodyProperties(BodiesClient& simulator)
    : simulator_(simulator),
      hint_(new QLabel),
      form_(new QWidget),
      grid_(new QGridLayout(form_)),
      heading_(new QLabel),
      kind_(new HintedBox),
      color_(new QToolButton) {
  setWidgetResizable(true);
  setFrameShape(QFrame::NoFrame);
  grid_->setContentsMargins(0, 2, 4, 2);
  grid_->setHorizontalSpacing(4);
  grid_->setVerticalSpacing(2);
  heading_->setTextFormat(Qt::PlainText);
  heading_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  grid_->addWidget(heading_, 0, 0, 1, kColumns);

  name_ = addRow("Name", "", "Of several bodies: the stem of their names, which are numbered", 1);
  connect(name_.fields[0], &ValueField::entered, this, &BodyProperties::enterName);
  connect(name_.fields[0], &ValueField::restored, this, [this] { note(name_, {}); });

  const int row = grid_->rowCount();
  kind_->addItems({"dynamic", "static", "kinematic"});
  kind_->setPlaceholderText("mixed");  // where bodies of several kinds are selected
  guardFromWheel(*kind_);
  kind_->setToolTip("Moved by forces; not moved; moved with its velocity, whatever it meets");
  color_->setToolTip("Colour");
  color_->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  kind_row_.title = new QLabel("Kind");
  grid_->addWidget(kind_row_.title, row, 0);
  grid_->addWidget(kind_, row, 1, 1, 2);
  grid_->addWidget(color_, row, 3);
  addNote(kind_row_);
  connect(kind_, qOverload<int>(&QComboBox::activated), this, &BodyProperties::chooseKind);
  connect(color_, &QToolButton::clicked, this, &BodyProperties::chooseColor);

  rows_.resize(bodyFields().size());
  for (const BodyField& field : bodyFields()) addNumbers(field);
  grid_->setRowStretch(grid_->rowCount(), 1);
  hint_->setWordWrap(true);
  form_->hide();
  auto* const page = new QWidget;
  auto* const both = new QVBoxLayout(page);
  both->setContentsMargins(0, 0, 0, 0);
  both->addWidget(hint_, 0, Qt::AlignTop);
  both->addWidget(form_);
  setWidget(page);

  connect(&simulator_, &BodiesClient::replayChanged, this, &BodyProperties::follow);
  connect(&simulator_, &BodiesClient::heardChanged, this, [this](bool is_heard) {
    const QList<ValueField*> fields = form_->findChildren<ValueField*>();
    const auto isTyping = [](const ValueField* field) { return field->isTyping(); };
    // What is typed would be entered as its field is disabled, and refused.
    if (is_heard || std::none_of(fields.begin(), fields.end(), isTyping)) form_->setEnabled(is_heard);
  });
  refresh_.setSingleShot(true);
  connect(&refresh_, &QTimer::timeout, this, &BodyProperties::follow);
  connect(&simulator_, &BodiesClient::motionChanged, this, [this] {
    if (!refresh_.isActive()) refresh_.start(kRefreshTime);
  });
}

BodyProperties::Row BodyProperties::addRow(const QString& name, const QString& unit, const QString& tip,
                                           int parts) {
  Row row;
  const int place = grid_->rowCount();
  row.title = new QLabel(unit.isEmpty() ? name : QString("%1, %2").arg(name, unit));
  row.title->setToolTip(tip);
  grid_->addWidget(row.title, place, 0);
  for (int part = 0; part < parts; ++part) {
    row.fields.push_back(new ValueField);
    row.fields.back()->setToolTip(tip);
    connect(row.fields.back(), &ValueField::restored, this, [this] { refresh_.start(0); });
    row.fields.back()->setAccessibleName(parts == 1 ? name : name + " " + QString("xyz")[part]);
    grid_->addWidget(row.fields.back(), place, 1 + part, 1, parts == 1 ? kColumns - 1 : 1);
  }
  addNote(row);
  return row;
}

void BodyProperties::addNote(Row& row) {
  row.note = new QLabel;
  row.note->setObjectName("note");
  row.note->setWordWrap(true);
  row.note->setTextFormat(Qt::PlainText);
  showTrouble(*row.note, true);
  row.note->hide();
  grid_->addWidget(row.note, grid_->rowCount(), 1, 1, kColumns - 1);
}

void BodyProperties::addNumbers(const BodyField& field) {
  const std::size_t index = &field - bodyFields().data();
  rows_[index] = addRow(field.title, field.unit, field.tip, field.parts);
  Row& row = rows_[index];
  for (int part = 0; part < field.parts; ++part) {
    connect(row.fields[part], &ValueField::entered, this,
            [this, &field, &row, part](const QString& text) { enterNumber(field, row, part, text); });
    connect(row.fields[part], &ValueField::restored, this, [this, &row] { note(row, {}); });
  }
}

void BodyProperties::editName() {
  name_.fields[0]->setFocus();
  name_.fields[0]->selectAll();
}

void BodyProperties::choose(const QStringList& names, const QString& hint) {
  chosen_ = names;
  hint_->setText(hint);
  follow();
}

// What is typed is about the bodies that the form showed when the typing began, whatever others select
// meanwhile.
void BodyProperties::follow() {
  bodies_.clear();
  if (isTyping()) findShown();
  if (bodies_.empty()) findChosen();
  // A name that has just been changed is selected by its old name for a moment.
  if (bodies_.empty() && !chosen_.isEmpty()) findShown();
  show();  // before the form is hidden: a field that loses the focus enters what is typed
  const QWidget* const focus = QApplication::focusWidget();
  if (bodies_.empty() && focus && form_->isAncestorOf(focus)) Q_EMIT left(heading_->text());
  hint_->setVisible(bodies_.empty());
  form_->setVisible(!bodies_.empty());
}

bool BodyProperties::isTyping() const {
  const QList<ValueField*> fields = form_->findChildren<ValueField*>();
  return std::any_of(fields.begin(), fields.end(),
                     [](const ValueField* field) { return field->hasFocus() && field->isModified(); });
}

// Another scene has other bodies of the same numbers.
void BodyProperties::findShown() {
  bodies_.clear();
  if (simulator_.scene() != shown_scene_) return;
  std::unordered_map<std::uint64_t, std::size_t> known;
  for (std::size_t i = 0; i < simulator_.bodies().size(); ++i) known.emplace(simulator_.bodies()[i].id, i);
  for (const std::uint64_t id : shown_) {
    const auto it = known.find(id);
    if (it != known.end())
      bodies_.push_back({&simulator_.bodies()[it->second], simulator_.motion(it->second)});
  }
}

void BodyProperties::findChosen() {
  bodies_.clear();
  for (const QString& name : chosen_)
    if (const auto i = simulator_.find(name))
      bodies_.push_back({&simulator_.bodies()[*i], simulator_.motion(*i)});
}

void BodyProperties::show() {
  QStringList names;
  std::vector<std::uint64_t> ids;
  for (const KnownBody& body : bodies_) {
    names.append(QString::fromStdString(body.description->name));
    ids.push_back(body.description->id);
  }
  if (ids != shown_ || simulator_.scene() != shown_scene_) {
    shown_ = std::move(ids);
    shown_scene_ = simulator_.scene();
    for (ValueField* const field : form_->findChildren<ValueField*>()) field->restore();
    note(kind_row_, {});
  }
  if (bodies_.empty()) return;
  const bool is_replay = simulator_.isReplay();
  heading_->setText((names.size() == 1 ? names[0] : QString("%1 bodies").arg(names.size())) +
                    (is_replay ? QString(", replayed: nothing can be changed") : QString()));
  for (QWidget* const editor : std::initializer_list<QWidget*>{name_.fields[0], kind_, color_})
    editor->setEnabled(!is_replay);
  name_.fields[0]->show(names.size() == 1 ? std::optional<QString>(names[0]) : std::nullopt);
  showKindAndColor();
  for (std::size_t k = 0; k < rows_.size(); ++k) showNumbers(bodyFields()[k], rows_[k]);
}

void BodyProperties::showKindAndColor() {
  if (!kind_->view()->isVisible()) {
    const auto kind = [](const KnownBody& body) {
      return std::make_optional(QString::fromStdString(body.description->kind));
    };
    kind_->setCurrentIndex(kind_->findText(commonText(bodies_, kind).value_or("")));
  }
  const std_msgs::ColorRGBA& first = bodies_.front().description->color;
  bool is_common = true;
  for (const KnownBody& body : bodies_) is_common = is_common && body.description->color == first;
  const QColor color = QColor::fromRgbF(first.r, first.g, first.b);
  color_->setIcon(is_common ? swatch(color, color_->iconSize().height()) : QIcon());
  color_->setText(is_common ? (first.a < 1.0f ? QString("%1 %").arg(std::lround(100 * first.a)) : QString())
                            : "mixed");
}

void BodyProperties::showNumbers(const BodyField& field, Row& row) {
  for (int part = 0; part < field.parts; ++part) {
    std::optional<double> common;
    bool differ = false;
    for (const KnownBody& body : bodies_) {
      const std::optional<double> value = field.read(body, part);
      if (!value || value == common) continue;
      differ = common && inText(field, *value) != inText(field, *common);
      if (differ) break;
      common = value;
    }
    row.fields[part]->setEnabled(common.has_value() && !simulator_.isReplay());
    if (!common) {
      row.fields[part]->show(QString("–"));
    } else {
      row.fields[part]->show(differ ? std::nullopt : std::make_optional(inText(field, *common)));
    }
  }
}

void BodyProperties::note(const Row& row, const QString& refusal) {
  row.note->setText(withoutPlace(refusal));
  row.note->setToolTip(refusal);
  row.note->setVisible(!refusal.isEmpty());
  if (refusal.isEmpty()) return;
  // Once it has its place: it may be below what is seen.
  QTimer::singleShot(0, row.note, [this, note = row.note] { ensureWidgetVisible(note); });
}

void BodyProperties::enterNumber(const BodyField& field, Row& row, int part, const QString& text) {
  ValueField* const editor = row.fields[part];
  Q_EMIT entered();
  const auto answer = [this, &row, editor](const QString& refusal) {
    editor->answer(refusal);
    if (!refusal.isEmpty()) note(row, refusal);
  };
  const std::optional<double> value = fromText(field, text);
  const auto refuse = [&](const char* allowed) {
    constexpr int kShown = 40;  // letters
    const QString shown = text.size() > kShown ? text.left(kShown) + "…" : text;
    answer(QString("%1 (allowed: %2)").arg(shown, allowed));
  };
  if (!value)
    return refuse(field.is_mask ? "a whole number, 0 to 0xffffffff" : "a number such as 1000 or 1.5");
  if (field.above_zero && *value == 0.0) return refuse("a number above 0");
  ask(
      [&](rigid_body_sim::BodyChange& change, const KnownBody& body) {
        if (field.read(body, part)) field.write(change, body, part, *value);
      },
      answer);
}

// "stone" for three bodies: stone_1, stone_2, stone_3.
void BodyProperties::enterName(const QString& text) {
  const bool is_one = bodies_.size() == 1;
  int number = 0;
  Q_EMIT entered();
  ask(
      [&](rigid_body_sim::BodyChange& change, const KnownBody&) {
        change.new_name = (is_one ? text : QString("%1_%2").arg(text).arg(++number)).toStdString();
      },
      [this](const QString& refusal) {
        name_.fields[0]->answer(refusal);
        if (!refusal.isEmpty()) note(name_, refusal);
      });
}

void BodyProperties::chooseKind(int index) {
  const std::string kind = kind_->itemText(index).toStdString();
  ask([&](rigid_body_sim::BodyChange& change, const KnownBody&) { change.kind = kind; },
      [this](const QString& refusal) { note(kind_row_, refusal); });
}

// The dialog stands beside a simulation that goes on, so it holds nothing up.
void BodyProperties::chooseColor() {
  const std_msgs::ColorRGBA& now = bodies_.front().description->color;
  auto* const dialog = new QColorDialog(QColor::fromRgbF(now.r, now.g, now.b, now.a), this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setOption(QColorDialog::ShowAlphaChannel);
  const std::vector<std::uint64_t> asked_for = shown_;
  connect(dialog, &QColorDialog::colorSelected, this, [this, asked_for](const QColor& color) {
    if (shown_ != asked_for) return note(kind_row_, "The selection has changed since; no colour was set.");
    if (color.alpha() == 0) return note(kind_row_, "a colour with some opacity");
    ask(
        [&](rigid_body_sim::BodyChange& change, const KnownBody&) {
          change.color.r = static_cast<float>(color.redF());
          change.color.g = static_cast<float>(color.greenF());
          change.color.b = static_cast<float>(color.blueF());
          change.color.a = static_cast<float>(color.alphaF());
        },
        [this](const QString& refusal) { note(kind_row_, refusal); });
  });
  dialog->open();
}

void BodyProperties::ask(const std::function<void(rigid_body_sim::BodyChange&, const KnownBody&)>& write,
                         const BodiesClient::Answer& answer) {
  findShown();
  const rigid_body_sim::BodyChange unchanged;
  std::vector<rigid_body_sim::BodyChange> changes;
  for (const KnownBody& body : bodies_) {
    rigid_body_sim::BodyChange change;
    write(change, body);
    if (change == unchanged) continue;
    change.name = body.description->name;
    changes.push_back(change);
  }
  if (bodies_.empty()) return answer("the bodies are gone");
  if (changes.empty()) return answer("none of these bodies has this property");
  simulator_.edit(changes, answer);
}

}  // namespace rbs
