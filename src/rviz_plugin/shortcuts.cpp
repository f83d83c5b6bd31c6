// SPDX-License-Identifier: BSD-3-Clause
#include "shortcuts.h"

#include <QAction>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>

namespace rbs {
namespace {

struct Shortcut {
  const char *keys, *what;
};
constexpr Shortcut kEverywhere[] = {
    {"Space", "run or pause"}, {".", "take steps, while paused"},  {"+, -", "double or halve the speed"},
    {"1", "wind on or off"},   {"R", "record; end the recording"}, {"Ctrl+Z, Ctrl+Shift+Z", "undo, redo"}};
constexpr Shortcut kInReplay[] = {{"Left, right", "go by a step"},
                                  {"Page up, page down", "go by a second"},
                                  {"Home, end", "go to the start, to the end"}};
constexpr Shortcut kInView[] = {
    {"Click", "select a body"},
    {"Ctrl+click", "add a body to the selection, or take it away"},
    {"S, then drag", "the tool Select: the bodies in a rectangle"},
    {"B", "the tool Add body: click adds, drag throws, wheel sizes, right click shapes"},
    {"Drag", "pull a body"},
    {"Right click", "menu of a body"},
    {"Delete", "delete the selected bodies"},
    {"Home", "the view of the scene"},
    {"Escape, click on nothing", "select nothing"}};
constexpr Shortcut kInList[] = {{"Letters, digits", "look for a name, and are no commands"},
                                {"F2", "rename"},
                                {"Delete", "delete"},
                                {"Ctrl+D", "duplicate"},
                                {"Ctrl+G", "make a group"},
                                {"F", "look at"},
                                {"H, Shift+H", "hide in the view; show all"},
                                {"Ctrl+A", "select all that are listed"}};

constexpr Shortcut kInPlots[] = {{"Alt+A", "add and remove plots"},
                                 {"Alt+L", "hold the picture"},
                                 {"Alt+O", "follow the newest"},
                                 {"Alt+B", "count from now"},
                                 {"Alt+X", "export"}};

template <std::size_t kCount>
QString table(const char* title, const Shortcut (&rows)[kCount]) {
  QString text = QString("<tr><td colspan=2><b>%1</b></td></tr>").arg(title);
  for (const Shortcut& row : rows)
    text += QString("<tr><td>%1&nbsp;&nbsp;</td><td>%2</td></tr>").arg(row.keys, row.what);
  return text;
}

void show(QWidget* window) {
  auto* const box = new QMessageBox(window);
  box->setAttribute(Qt::WA_DeleteOnClose);
  box->setWindowTitle("Keys and mouse of the simulation");
  box->setTextFormat(Qt::RichText);
  box->setText("<table>" + table("Everywhere", kEverywhere) +
               table("In the view, with the tool Interact", kInView) +
               table("In the list of bodies", kInList) + table("In the panel of plots", kInPlots) +
               table("On the slider of a replay", kInReplay) + "</table>");
  box->open();
}

}  // namespace

void offerShortcuts(QWidget& window, QObject& owner) {
  const auto* const bar = window.findChild<QMenuBar*>();
  if (!bar) return;
  for (QAction* const entry : bar->actions()) {
    if (!entry->menu() || entry->text().remove('&') != "Help") continue;
    for (const QAction* const other : entry->menu()->actions())
      if (other->objectName() == kShortcutsName) return;
    auto* const action = new QAction("Keys of the &simulation", &owner);
    action->setObjectName(kShortcutsName);
    QObject::connect(action, &QAction::triggered, &owner, [&window] { show(&window); });
    entry->menu()->addAction(action);
  }
}

}  // namespace rbs
