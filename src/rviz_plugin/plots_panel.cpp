// SPDX-License-Identifier: BSD-3-Clause
#include "plots_panel.h"

#include "plot_export.h"
#include "quiet_end.h"
#include "scrolled.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QMenu>
#include <QVBoxLayout>

#include <pluginlib/class_list_macros.hpp>

#include <algorithm>

namespace rbs {
namespace {

constexpr double kWindows[] = {2.0, 5.0, 10.0, 30.0, 60.0, 300.0, 0.0};  // s
constexpr const char* kShownAtFirst[] = {"energy", "real-time factor", "step time", "stage times"};

QString windowText(double seconds) {
  if (seconds == 0.0) return "all";
  return seconds < 60.0 ? QString("%1 s").arg(seconds) : QString("%1 min").arg(seconds / 60.0);
}

QToolButton* makeButton(const QString& text, const QString& tip) {
  auto* button = new QToolButton;
  button->setText(text);
  button->setToolTip(tip);
  return button;
}

}  // namespace

PlotsPanel::PlotsPanel()
    : pages_(new QTabWidget),
      accuracy_(new AccuracyView(simulator_)),
      plots_(new PlotStack(recorder_)),
      picker_(new QuantityPicker(this)),
      add_(makeButton("&Add", "Adds and removes plots")),
      pause_(makeButton("Ho&ld", "Holds the picture still; recording goes on")),
      follow_(makeButton("F&ollow", "Goes back to the newest, with scales that fit (also a double click)")),
      baseline_(makeButton("&Baseline",
                           "Counts from now: curves show the change since then, their values before "
                           "and after")),
      export_(makeButton("E&xport", "Writes the plots as a picture (.png, .svg) or a table (.csv)")),
      window_(new QComboBox),
      cursor_(new QLabel),
      node_(new NodeBox),
      message_(new ElidedText(2)),
      folder_(QDir::currentPath()) {
  node_->setNode("sim");
  node_->setToolTip("The simulator that is plotted: the name of its node");
  for (const double seconds : kWindows) window_->addItem(windowText(seconds), seconds);
  window_->setToolTip("How much simulated time is seen; all: the whole run");
  for (QToolButton* button : {pause_, follow_, baseline_}) button->setCheckable(true);
  makeBaselineMenu();
  layOut();
  connectWidgets();
  for (const char* name : kShownAtFirst) plots_->add(*findQuantity(name), {});
  plots_->setWindow(10.0);
}

PlotsPanel::~PlotsPanel() {
  endQuietly(*this);
}

void PlotsPanel::makeBaselineMenu() {
  auto* const menu = new QMenu(this);
  menu->addAction("From the last change on", this, [this] {
    if (!plots_->setBaselineAtMark())
      showNote("Nothing has been changed in this run, so there is nothing to compare.");
    showView();
  });
  baseline_->setMenu(menu);
  baseline_->setPopupMode(QToolButton::MenuButtonPopup);
}

void PlotsPanel::layOut() {
  pages_->setDocumentMode(true);
  pages_->addTab(timePage(), "Over time");
  pages_->addTab(scrolled(accuracy_), "Accuracy");
  pages_->setTabToolTip(1, "Error against CPU time of each choice of solver settings; a click takes one");
  auto* const last_row = new QHBoxLayout;
  last_row->addWidget(cursor_, 1);
  last_row->addWidget(new QLabel("Node"));
  last_row->addWidget(node_);
  auto* const rows = new QVBoxLayout(this);
  rows->setContentsMargins(6, 4, 6, 4);
  rows->setSpacing(4);
  rows->addWidget(pages_, 1);
  rows->addWidget(message_);
  rows->addLayout(last_row);
  cursor_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  message_->hide();
}

QWidget* PlotsPanel::timePage() {
  auto* const row = new QHBoxLayout;
  row->setSpacing(2);
  for (QToolButton* button : {add_, pause_, follow_}) row->addWidget(button);
  row->addWidget(window_);
  row->addWidget(baseline_);
  row->addWidget(export_);
  row->addStretch(1);
  auto* const page = new QWidget;
  auto* const rows = new QVBoxLayout(page);
  rows->setContentsMargins(0, 4, 0, 0);
  rows->setSpacing(4);
  rows->addLayout(row);
  rows->addWidget(plots_, 1);
  return page;
}

void PlotsPanel::connectWidgets() {
  connect(add_, &QToolButton::clicked, this, &PlotsPanel::openPicker);
  connect(picker_, &QuantityPicker::toggled, this, &PlotsPanel::toggle);
  connect(pause_, &QToolButton::toggled, plots_, &PlotStack::hold);
  connect(follow_, &QToolButton::clicked, plots_, &PlotStack::follow);
  connect(baseline_, &QToolButton::clicked, plots_, &PlotStack::setBaseline);
  connect(export_, &QToolButton::clicked, this, &PlotsPanel::exportTo);
  connect(window_, qOverload<int>(&QComboBox::activated), this, [this](int index) {
    plots_->setWindow(window_->itemData(index).toDouble());
    Q_EMIT configChanged();
  });
  connect(node_, &NodeBox::chosen, this, [this](const QString& node) {
    if (node == recorder_.node()) return;
    follow(node);
    Q_EMIT configChanged();
  });
  connect(plots_, &PlotStack::plotsChanged, this, &PlotsPanel::configChanged);
  connect(plots_, &PlotStack::viewChanged, this, &PlotsPanel::showView);
  connect(plots_, &PlotStack::cursorMoved, this, &PlotsPanel::showCursor);
  connect(&recorder_, &Recorder::reported, this, &PlotsPanel::showNote);
  connect(&recorder_, &Recorder::bodiesChanged, this, [this] {
    if (picker_->isVisible()) picker_->setBodies(recorder_.bodies());
  });
  connect(&simulator_, &SimulatorClient::statusReceived, accuracy_, &AccuracyView::show);
  connect(&simulator_, &SimulatorClient::reported, this, [this](const QString& text) {
    if (accuracy_->isVisible()) showNote(text);
  });
  connect(pages_, &QTabWidget::currentChanged, cursor_, &QLabel::clear);
  connect(&recorder_, &Recorder::heardChanged, accuracy_, &QWidget::setEnabled);
  connect(&recorder_, &Recorder::heardChanged, this, [this](bool is_heard) {
    showNote(is_heard ? QString() : QString("No simulator answers at '%1'.").arg(recorder_.node()));
  });
}

void PlotsPanel::onInitialize() {
  shareDock(*this);
  follow(node_->node());
  showView();
}

void PlotsPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  float window = 0.0f;
  if (config.mapGetFloat("Window", &window)) plots_->setWindow(window);
  window_->setCurrentIndex(window_->findData(plots_->window()));
  int page = 0;
  if (config.mapGetInt("Page", &page)) pages_->setCurrentIndex(page);
  const rviz::Config plots = config.mapGetChild("Plots");
  if (plots.isValid()) plots_->removeAll();
  for (int i = 0; i < plots.listLength(); ++i) {
    QString name;
    plots.listChildAt(i).mapGetString("Quantity", &name);
    const Quantity* const quantity = findQuantity(name.toStdString());
    if (!quantity) continue;  // of another version
    const rviz::Config bodies = plots.listChildAt(i).mapGetChild("Bodies");
    if (!quantity->isOfBody()) plots_->add(*quantity, {});
    for (int k = 0; quantity->isOfBody() && k < bodies.listLength(); ++k)
      plots_->add(*quantity, bodies.listChildAt(k).getValue().toString());
  }
  QString node;
  if (config.mapGetString("Node", &node)) follow(node);
}

void PlotsPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", node_->node());
  config.mapSetValue("Window", plots_->window());
  config.mapSetValue("Page", pages_->currentIndex());
  rviz::Config list = config.mapMakeChild("Plots");
  list.setType(rviz::Config::List);
  for (const TimePlot* const plot : plots_->plots()) {
    rviz::Config entry = list.listAppendNew();
    entry.mapSetValue("Quantity", QString::fromStdString(plot->quantity().name));
    if (!plot->quantity().isOfBody()) continue;
    rviz::Config bodies = entry.mapMakeChild("Bodies");
    for (const QString& body : plot->bodies()) bodies.listAppendNew().setValue(body);
  }
}

void PlotsPanel::follow(const QString& node) {
  node_->setNode(node);
  showNote(QString("No simulator answers at '%1'.").arg(node));
  pause_->setChecked(false);
  plots_->restart();
  accuracy_->setEnabled(false);
  recorder_.follow(node);
  simulator_.follow(node);
}

void PlotsPanel::openPicker() {
  recorder_.listBodies();
  picker_->open(add_->mapToGlobal(add_->rect().bottomLeft()), recorder_.bodies(),
                [this](const Quantity& quantity) { return plots_->find(quantity) != nullptr; });
}

// The list stays open, so that several are added at once.
void PlotsPanel::toggle(const Quantity& quantity, const QString& body) {
  TimePlot* const plot = plots_->find(quantity);
  if (plot && !quantity.isOfBody()) return plots_->remove(plot);
  plots_->add(quantity, body);
}

void PlotsPanel::exportTo() {
  auto* const dialog =
      new QFileDialog(this, "Export plots", folder_,
                      "Table of numbers (*.csv);;Picture (*.png);;Drawing (*.svg);;All files (*)");
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix("csv");
  connect(dialog, &QFileDialog::filterSelected, dialog, [dialog](const QString& filter) {
    for (const char* kind : {"csv", "png", "svg"})
      if (filter.contains(QString("*.%1").arg(kind))) dialog->setDefaultSuffix(kind);
  });
  connect(dialog, &QFileDialog::fileSelected, this, &PlotsPanel::write);
  dialog->open();
}

void PlotsPanel::write(const QString& path) {
  const QString trouble = exportPlots(*plots_, path);
  if (trouble.isEmpty()) folder_ = QFileInfo(path).path();
  showNote(trouble.isEmpty() ? QString("'%1' is written.").arg(path) : trouble);
}

void PlotsPanel::showView() {
  follow_->setChecked(plots_->isFollowing());
  baseline_->setChecked(plots_->hasBaseline());
}

void PlotsPanel::showCursor(std::optional<double> time) {
  cursor_->setText(time ? QString("%1 s").arg(*time, 0, 'f', 4) : QString());
}

void PlotsPanel::showNote(const QString& text) {
  message_->setText(text);
  message_->setVisible(!text.isEmpty());
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::PlotsPanel, rviz::Panel)
