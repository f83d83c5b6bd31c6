// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_panel.h"

#include "bodies_display.h"
#include "body_names.h"
#include "colors.h"
#include "duplicate_dialog.h"
#include "quiet_end.h"
#include "scrolled.h"
#include "wheel_guard.h"

#include <OgreAxisAlignedBox.h>
#include <rviz/frame_manager.h>
#include <rviz/view_manager.h>
#include <pluginlib/class_list_macros.hpp>

#include <QAction>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QInputDialog>
#include <QKeyEvent>
#include <QLabel>
#include <QRegularExpression>
#include <QSplitter>
#include <QToolButton>
#include <QVBoxLayout>

#include <algorithm>
#include <set>

namespace rbs {
namespace {

const QString kAllBodies = "All bodies";
const QString kHowToSelect = "Select bodies in this list or in the view to see and edit their properties.";
const QString kNoneListed =
    "The selected bodies are not listed. Only bodies that are listed are changed here.";
constexpr int kReadIn = 10000;  // ms

// "changes[0] ('box_1').name: 'a b' (allowed: ...)" is about the name of box_1.
QString bodyFirst(const QString& refusal) {
  static const QRegularExpression place(R"(^changes\[\d+\] \(('[^']*')\)(\.|: ))");
  const QRegularExpressionMatch match = place.match(refusal);
  if (!match.hasMatch()) return refusal;
  return match.captured(1) + (match.captured(2) == "." ? ", " : ": ") + refusal.mid(match.capturedEnd());
}

QString bodyCount(int n) {
  return n == 1 ? QString("1 body") : QString("%1 bodies").arg(n);
}

}  // namespace

BodiesPanel::BodiesPanel()
    : table_(simulator_),
      filter_(table_),
      search_(new QLineEdit),
      groups_(new QComboBox),
      list_(new QTableView),
      count_(new QLabel),
      properties_(new BodyProperties(simulator_)),
      answer_(new ElidedText(2)),
      node_(new NodeBox) {
  node_->setNode("sim");
  // Before the list learns of it: rows that a filter hides stay selected.
  connect(&filter_, &QAbstractItemModel::rowsAboutToBeRemoved, this, [this] { filters_ = true; });
  layOut();
  connect(&filter_, &QAbstractItemModel::rowsRemoved, this, [this] { filters_ = false; });
  addActions();
  showGroups(kAllBodies);

  done_.setSingleShot(true);
  connect(&done_, &QTimer::timeout, this, [this] { showMessage({}, false); });
  connect(&simulator_, &BodiesClient::reported, this, &BodiesPanel::showMessage);
  connect(properties_, &BodyProperties::entered, this, [this] { showMessage({}, false); });
  // Else Qt hands the focus to a field of another purpose, which takes what is still typed.
  connect(properties_, &BodyProperties::left, this, [this](const QString& heading) {
    list_->setFocus();
    if (!simulator_.find(heading) && !heading.endsWith(" bodies"))
      showMessage(QString("'%1' is gone.").arg(heading), true);
  });
  connect(&simulator_, &BodiesClient::selectionChanged, this, &BodiesPanel::showSelection);
  connect(&simulator_, &BodiesClient::bodiesChanged, this, &BodiesPanel::showSelection);
  connect(&simulator_, &BodiesClient::replayChanged, this, &BodiesPanel::enableActions);
  connect(&simulator_, &BodiesClient::heardChanged, this, [this] {
    showMessage({}, false);
    enableActions();
  });
  connect(&simulator_, &BodiesClient::bodiesChanged, this, &BodiesPanel::applyHidden);
  connect(&simulator_, &BodiesClient::renamed, this, &BodiesPanel::followRenames);
  connect(list_->selectionModel(), &QItemSelectionModel::selectionChanged, this, &BodiesPanel::sendSelection);
  connect(list_, &QTableView::doubleClicked, this, [this](const QModelIndex& index) {
    if (index.column() != BodyTable::Name) focus();
  });
  connect(&table_, &BodyTable::renameAsked, this, &BodiesPanel::rename);
  connect(&table_, &BodyTable::updating, this, [this](bool begins) { shows_selection_ = begins; });
  connect(search_, &QLineEdit::textChanged, this, [this](const QString& text) {
    filter_.setText(text);
    showSelection();
    showCount();
  });
  connect(groups_, qOverload<int>(&QComboBox::activated), this, &BodiesPanel::chooseGroup);
  connect(node_, &NodeBox::chosen, this, [this](const QString& node) {
    if (node == simulator_.node()) return;
    follow(node);
    Q_EMIT configChanged();
  });
}

BodiesPanel::~BodiesPanel() {
  endQuietly(*this);
  hideInView({});
}

void BodiesPanel::layOut() {
  count_->setObjectName("count");
  search_->setObjectName("search");
  search_->setPlaceholderText("Search: name, shape, kind");
  search_->setClearButtonEnabled(true);
  groups_->setObjectName("groups");
  guardFromWheel(*groups_);
  groups_->setToolTip("Lists only the bodies of a group");
  groups_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  groups_->setMinimumContentsLength(8);

  list_->setModel(&filter_);
  list_->setSelectionBehavior(QAbstractItemView::SelectRows);
  list_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  list_->setEditTriggers(QAbstractItemView::DoubleClicked | QAbstractItemView::EditKeyPressed);
  list_->setContextMenuPolicy(Qt::ActionsContextMenu);
  list_->installEventFilter(this);
  list_->viewport()->installEventFilter(this);
  list_->setSortingEnabled(true);
  list_->sortByColumn(-1, Qt::AscendingOrder);  // the order of creation
  list_->setShowGrid(false);
  list_->setWordWrap(false);
  list_->verticalHeader()->hide();
  list_->verticalHeader()->setDefaultSectionSize(list_->fontMetrics().height() + 4);
  list_->horizontalHeader()->setHighlightSections(false);
  list_->horizontalHeader()->setSectionResizeMode(BodyTable::Name, QHeaderView::Stretch);
  for (const int column : {BodyTable::Shape, BodyTable::Kind, BodyTable::Mass})
    list_->setColumnWidth(column, list_->fontMetrics().horizontalAdvance("kinematic") + 14);

  auto* const filters = new QHBoxLayout;
  filters->addWidget(search_, 2);
  filters->addWidget(groups_, 1);
  auto* const split = new QSplitter(Qt::Vertical);
  split->addWidget(list_);
  split->addWidget(properties_);
  split->setChildrenCollapsible(false);
  split->setSizes({200, 200});
  auto* const last_row = new QHBoxLayout;
  last_row->addWidget(count_);
  last_row->addStretch();
  last_row->addWidget(new QLabel("Node"));
  last_row->addWidget(node_);
  auto* const panel = new QVBoxLayout(this);
  panel->setContentsMargins(6, 4, 6, 4);
  panel->setSpacing(4);
  panel->addLayout(filters);
  panel->addWidget(split, 1);
  panel->addWidget(answer_);
  panel->addLayout(last_row);
}

void BodiesPanel::addActions() {
  of_selection_ = {addAction("Look at", Qt::Key_F, &BodiesPanel::focus)};
  edits_ = {addAction("Duplicate…", Qt::CTRL | Qt::Key_D, &BodiesPanel::duplicate),
            addAction("Delete", Qt::Key_Delete, &BodiesPanel::remove)};
  of_selection_ += edits_;
  of_selection_ +=
      QList<QAction*>{addAction("Make a group…", Qt::CTRL | Qt::Key_G, &BodiesPanel::groupSelection),
                      addAction("Hide in the view", Qt::Key_H, &BodiesPanel::hideSelection)};
  show_all_ = addAction("Show all", Qt::SHIFT | Qt::Key_H, &BodiesPanel::showAll);
  ungroup_ = addAction("Forget the group", {}, &BodiesPanel::ungroup);
  enableActions();
}

void BodiesPanel::enableActions() {
  const bool has_any = !chosen().isEmpty();
  for (QAction* const action : of_selection_)
    action->setEnabled(has_any && (simulator_.takesEdits() || !edits_.contains(action)));
  show_all_->setEnabled(!hidden_.isEmpty());
  ungroup_->setEnabled(in_group_.contains(groups_->currentText()));
}

QAction* BodiesPanel::addAction(const QString& text, const QKeySequence& keys, void (BodiesPanel::*act)()) {
  auto* const action = new QAction(text, list_);
  action->setShortcut(keys);
  action->setShortcutContext(Qt::WidgetShortcut);
  connect(action, &QAction::triggered, this, act);
  list_->addAction(action);
  return action;
}

// Letters and digits look for a name, as in any list, and are no commands, but for those of the list itself.
bool BodiesPanel::eventFilter(QObject* watched, QEvent* event) {
  const auto isExtending = [](const QInputEvent& input) {
    return (input.modifiers() & (Qt::ControlModifier | Qt::ShiftModifier)) != Qt::NoModifier;
  };
  if (event->type() == QEvent::MouseButtonPress) {
    extends_ = isExtending(*static_cast<QInputEvent*>(event));
    // Once the list has had it: a press on what is selected, or on nothing, may still drop what is not listed.
    if (!extends_) QTimer::singleShot(0, this, &BodiesPanel::sendSelection);
  } else if (event->type() == QEvent::KeyPress) {
    const auto& key = *static_cast<QKeyEvent*>(event);
    const bool moves =
        key.key() == Qt::Key_Space || (Qt::Key_Home <= key.key() && key.key() <= Qt::Key_PageDown);
    extends_ = key.matches(QKeySequence::SelectAll) ||
               (moves && isExtending(key));  // a capital letter looks for a name
  }
  if (watched != list_ || event->type() != QEvent::ShortcutOverride)
    return rviz::Panel::eventFilter(watched, event);
  const auto* const key = static_cast<QKeyEvent*>(event);
  const QString text = key->text();
  const bool is_word =
      key->modifiers() == Qt::NoModifier && !text.isEmpty() && text.front().isLetterOrNumber();
  const QList<QAction*> own = list_->actions();
  const bool is_own = std::any_of(own.begin(), own.end(), [key](const QAction* action) {
    return action->shortcut() == QKeySequence(key->key());
  });
  if (is_word && !is_own) event->accept();
  return is_word && !is_own;
}

void BodiesPanel::onInitialize() {
  manager_ = vis_manager_;
  shareDock(*this);
  follow(node_->node());
}

void BodiesPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  const rviz::Config groups = config.mapGetChild("Groups");
  for (auto it = groups.mapIterator(); it.isValid(); it.advance()) {
    const rviz::Config names = it.currentChild();
    for (int i = 0; i < names.listLength(); ++i)
      in_group_[it.currentKey()].append(names.listChildAt(i).getValue().toString());
  }
  showGroups(kAllBodies);
  QString node;
  if (config.mapGetString("Node", &node)) follow(node);
  const rviz::Config hidden = config.mapGetChild("Hidden");
  for (int i = 0; i < hidden.listLength(); ++i) hidden_.insert(hidden.listChildAt(i).getValue().toString());
}

void BodiesPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", node_->node());
  rviz::Config hidden = config.mapMakeChild("Hidden");
  for (const QString& name : hidden_) hidden.listAppendNew().setValue(name);
  rviz::Config groups = config.mapMakeChild("Groups");
  for (auto it = in_group_.begin(); it != in_group_.end(); ++it) {
    rviz::Config names = groups.mapMakeChild(it.key());
    for (const QString& name : it.value()) names.listAppendNew().setValue(name);
  }
}

void BodiesPanel::follow(const QString& node) {
  if (node != simulator_.node() && !simulator_.node().isEmpty()) {
    hideInView({});
    hidden_.clear();
  }
  node_->setNode(node);
  answer_->setText({});
  simulator_.follow(node);
  if (answer_->text().isEmpty()) showMessage({}, false);
}

// Rows that are side by side are selected as one range: thousands of ranges would take seconds.
void BodiesPanel::showSelection() {
  std::vector<int> rows;
  for (const QString& name : simulator_.selection())
    if (const QModelIndex index = indexOf(name); index.isValid()) rows.push_back(index.row());
  std::sort(rows.begin(), rows.end());
  QItemSelection selection;
  for (std::size_t k = 0, first = 0; k < rows.size(); ++k) {
    if (k + 1 < rows.size() && rows[k + 1] == rows[k] + 1) continue;
    selection.select(filter_.index(rows[first], 0), filter_.index(rows[k], BodyTable::kColumns - 1));
    first = k + 1;
  }
  shows_selection_ = true;
  list_->selectionModel()->select(selection, QItemSelectionModel::ClearAndSelect);
  shows_selection_ = false;
  if (!selection.isEmpty() && !list_->hasFocus()) list_->scrollTo(selection.first().topLeft());
  properties_->choose(chosen(), simulator_.selection().isEmpty() ? kHowToSelect : kNoneListed);
  enableActions();
  showCount();
}

QModelIndex BodiesPanel::indexOf(const QString& name) const {
  const std::optional<std::size_t> row = simulator_.find(name);
  return row ? filter_.mapFromSource(table_.index(static_cast<int>(*row), 0)) : QModelIndex();
}

bool BodiesPanel::isHiddenBySearch(const QString& name) const {
  return simulator_.find(name) && !indexOf(name).isValid();
}

QStringList BodiesPanel::chosen() const {
  QStringList names;
  for (const QString& name : simulator_.selection())
    if (!isHiddenBySearch(name)) names.append(name);
  return names;
}

// What is selected last comes last. What the filter hides stays selected while a selection is extended; else an edit would
// change what nobody sees.
void BodiesPanel::sendSelection() {
  if (shows_selection_ || filters_) return;
  QSet<QString> chosen;
  QStringList rows;
  for (const QModelIndex& index : list_->selectionModel()->selectedRows()) {
    rows.append(table_.name(filter_.mapToSource(index).row()));
    chosen.insert(rows.last());
  }
  QStringList names;
  QSet<QString> kept;
  for (const QString& name : simulator_.selection()) {
    if (isHiddenBySearch(name) ? !extends_ : !chosen.contains(name)) continue;
    names.append(name);
    kept.insert(name);
  }
  for (const QString& name : rows)
    if (!kept.contains(name)) names.append(name);
  if (names == simulator_.selection()) return;
  showMessage({}, false);
  simulator_.select(names);
}

void BodiesPanel::showCount() {
  const int all = table_.rowCount(), listed = filter_.rowCount(), selected = simulator_.selection().size();
  const int unlisted = selected - chosen().size();
  QString text = bodyCount(all);
  if (listed < all) text = QString("%1 of ").arg(listed) + text;
  if (selected > 0) text += QString(", %1 selected").arg(selected);
  if (unlisted > 0) text += QString(", %1 of them not listed").arg(unlisted);
  count_->setText(text);
}

// While nothing is heard, that is what there is to say. Else it is over after a while, trouble a little later.
void BodiesPanel::showMessage(const QString& text, bool is_trouble) {
  const bool is_heard = simulator_.isHeard();
  answer_->setText(is_heard || !text.isEmpty() ? bodyFirst(text) : simulator_.silence());
  showTrouble(*answer_, is_trouble || !is_heard);
  if (text.isEmpty() || !is_heard)
    done_.stop();
  else
    done_.start(is_trouble ? 3 * kReadIn : kReadIn);
}

void BodiesPanel::rename(const QString& name, const QString& new_name) {
  rigid_body_sim::BodyChange change;
  change.name = name.toStdString();
  change.new_name = new_name.toStdString();
  simulator_.edit({change}, [](const QString&) {});
}

// Groups and hidden bodies are kept by their names, which the layout keeps as well.
void BodiesPanel::followRenames(const QHash<QString, QString>& new_names) {
  for (QStringList& names : in_group_)
    for (QString& name : names) name = new_names.value(name, name);
  QSet<QString> hidden;
  for (const QString& name : hidden_) hidden.insert(new_names.value(name, name));
  hidden_ = hidden;
  filter_.setGroup(in_group_.value(groups_->currentText()));
  Q_EMIT configChanged();
}

// The view turns about the middle of the bodies' bounds.
void BodiesPanel::focus() {
  Ogre::AxisAlignedBox bounds;
  for (const QString& name : chosen()) {
    const std::optional<std::size_t> i = simulator_.find(name);
    const std::optional<BodyMotion> motion = i ? simulator_.motion(*i) : std::nullopt;
    if (!motion) continue;
    const geometry_msgs::Point& p = motion->pose.position;
    bounds.merge(Ogre::Vector3(p.x, p.y, p.z));
  }
  if (bounds.isNull()) return showMessage("The simulator has not sent where these bodies are.", true);
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  if (!vis_manager_->getFrameManager()->getTransform(simulator_.frame(), ros::Time(), position, orientation))
    return showMessage(QString("There is no transform from '%1' to the fixed frame.")
                           .arg(QString::fromStdString(simulator_.frame())),
                       true);
  if (rviz::ViewController* const view = vis_manager_->getViewManager()->getCurrent())
    view->lookAt(position + orientation * bounds.getCenter());
}

void BodiesPanel::hideSelection() {
  for (const QString& name : chosen()) hidden_.insert(name);
  applyHidden();
  Q_EMIT configChanged();
}

void BodiesPanel::showAll() {
  hidden_.clear();
  applyHidden();
  Q_EMIT configChanged();
}

// A display may be added later, so this is done again with every list of bodies. What is gone is hidden no more.
void BodiesPanel::applyHidden() {
  std::set<std::string> names;
  for (const rigid_body_sim::BodyDescription& body : simulator_.bodies())
    if (hidden_.contains(QString::fromStdString(body.name))) names.insert(body.name);
  if (!simulator_.bodies().empty()) {
    hidden_.clear();
    for (const std::string& name : names) hidden_.insert(QString::fromStdString(name));
  }
  table_.setHidden(hidden_);
  enableActions();
  hideInView(names);
}

void BodiesPanel::hideInView(const std::set<std::string>& names) {
  const std::string node = resolvedNode(simulator_.node());
  if (!manager_ || node.empty()) return;
  for (BodiesDisplay* const display : BodiesDisplay::allIn(*manager_))
    if (display->node() == node) display->setHidden(names);
}

void BodiesPanel::remove() {
  simulator_.remove(chosen());
}

void BodiesPanel::duplicate() {
  const QStringList names = chosen();
  auto* const dialog = new DuplicateDialog(names.size(), this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  connect(dialog, &QDialog::accepted, this,
          [this, dialog, names] { simulator_.duplicate(names, dialog->count(), dialog->offset()); });
  dialog->open();
}

void BodiesPanel::groupSelection() {
  auto* const dialog = new QInputDialog(this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setWindowTitle("Make a group");
  const QStringList bodies = chosen();
  dialog->setLabelText(QString("Name of the group of %1:").arg(bodyCount(bodies.size())));
  connect(dialog, &QInputDialog::textValueSelected, this, [this, bodies](const QString& text) {
    const QString name = text.simplified();
    if (name.isEmpty() || name == kAllBodies || in_group_.contains(name))
      return showMessage("A group needs a name of its own.", true);
    in_group_[name] = bodies;
    showGroups(name);
    chooseGroup(groups_->currentIndex());
    Q_EMIT configChanged();
  });
  dialog->open();
}

void BodiesPanel::ungroup() {
  in_group_.remove(groups_->currentText());
  showGroups(kAllBodies);
  chooseGroup(0);
  Q_EMIT configChanged();
}

void BodiesPanel::showGroups(const QString& chosen) {
  groups_->clear();
  groups_->addItem(kAllBodies);
  groups_->addItems(in_group_.keys());
  groups_->setCurrentText(chosen);
}

void BodiesPanel::chooseGroup(int index) {
  filter_.setGroup(in_group_.value(groups_->itemText(index)));
  showSelection();
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::BodiesPanel, rviz::Panel)
