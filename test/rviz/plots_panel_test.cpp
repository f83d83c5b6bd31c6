// SPDX-License-Identifier: BSD-3-Clause
// The panel of plots beside a running simulator, by keys and mouse; without a screen.
#include "wait_for.h"

#include "body_renames.h"
#include "plots_panel.h"
#include "shortcuts.h"
#include "time_plot.h"

#include <rigid_body_sim/EditBodies.h>
#include <rigid_body_sim/MeasureAccuracy.h>
#include <ros/package.h>
#include <ros/ros.h>

#include <QApplication>
#include <QHelpEvent>
#include <QMainWindow>
#include <QMenuBar>
#include <QMessageBox>
#include <QTest>
#include <QToolTip>

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

using namespace rbs;
using rbs::test::waitFor;

namespace {

class PlotsPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    QObject::connect(&simulator_, &SimulatorClient::statusReceived,
                     [this](const rigid_body_sim::Status& status) { status_ = status; });
    QObject::connect(&simulator_, &SimulatorClient::studyReceived,
                     [this](const rigid_body_sim::AccuracyStudy& study) { study_ = study; });
    simulator_.follow("/sim");
    ASSERT_TRUE(waitFor([this] { return !status_.scene.empty(); }));
    panel_.resize(500, 600);
    panel_.initialize(nullptr);
    panel_.show();
  }

  /// The page of the accuracy, chosen by its tab.
  AccuracyPlot& openAccuracy() {
    QTabBar& tabs = *panel_.findChild<QTabBar*>();
    QTest::mouseClick(&tabs, Qt::LeftButton, {}, tabs.tabRect(1).center());
    return *panel_.findChild<AccuracyPlot*>();
  }

  PlotStack& plotHeights(const QStringList& bodies) {
    rviz::Config layout;
    rviz::Config plot = layout.mapMakeChild("Plots").listAppendNew();
    plot.mapSetValue("Quantity", "height");
    rviz::Config names = plot.mapMakeChild("Bodies");
    for (const QString& body : bodies) names.listAppendNew().setValue(body);
    layout.mapSetValue("Node", "/sim");
    panel_.load(layout);
    return *panel_.findChild<PlotStack*>();
  }

  static void rename(const char* name, const char* new_name) {
    rigid_body_sim::EditBodies edit;
    edit.request.changes.resize(1);
    edit.request.changes[0].name = name;
    edit.request.changes[0].new_name = new_name;
    EXPECT_TRUE(ros::service::call("/sim/edit_bodies", edit) && edit.response.success)
        << edit.response.message;
  }

  SimulatorClient simulator_;
  rigid_body_sim::Status status_;
  rigid_body_sim::AccuracyStudy study_;
  PlotsPanel panel_;
};

TEST_F(PlotsPanelTest, ShowsTheCostOfAccuracyAndAClickAppliesIt) {
  AccuracyPlot& chart = openAccuracy();
  QPushButton& measure = *panel_.findChild<QPushButton*>();
  ASSERT_TRUE(waitFor([&] { return measure.isEnabled() && measure.isVisible(); }));
  QTest::mouseClick(&measure, Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return !study_.settings.empty() && study_.done && chart.isVisible(); }));
  EXPECT_TRUE(study_.trouble.empty()) << study_.trouble;
  // Each setting that stands alone, as the chart itself names what is under the mouse.
  int taken = 0;
  for (const rigid_body_sim::SettingCost& cost : study_.settings) {
    const QPoint at(static_cast<int>(chart.transform(QwtPlot::xBottom, cost.step_ms)),
                    static_cast<int>(chart.transform(QwtPlot::yLeft, std::max(cost.error, 1e-15))));
    if (!chart.nameAt(at).startsWith(QString::fromStdString(cost.name) + ":")) continue;
    QTest::mouseClick(chart.canvas(), Qt::LeftButton, {}, at);
    EXPECT_TRUE(waitFor([&] { return status_.fidelity == cost.name; }))
        << status_.fidelity << " in place of " << cost.name;
    if (++taken == 3) break;
  }
  EXPECT_GE(taken, 2);
}

TEST_F(PlotsPanelTest, KeepsThePageInTheLayout) {
  rviz::Config layout;
  openAccuracy();
  panel_.save(layout);
  PlotsPanel other;
  other.load(layout);
  EXPECT_EQ(other.findChild<QTabWidget*>()->currentIndex(), 1);
}

TEST_F(PlotsPanelTest, FollowsABodyThatIsRenamed) {
  PlotStack& plots = plotHeights({"ball"});
  const auto samples = [&](const char* body) {
    return plots.history().present(std::string("height of ") + body).size();
  };
  ASSERT_TRUE(waitFor([&] { return samples("ball") >= 1; }));
  simulator_.step(30);
  ASSERT_TRUE(waitFor([&] { return samples("ball") >= 2; }));
  const std::size_t before = samples("ball");
  rename("ball", "globe");
  EXPECT_TRUE(waitFor([&] { return plots.plots().front()->bodies() == QStringList("globe"); }));
  EXPECT_GE(samples("globe"), before) << "the curve goes on";
  EXPECT_EQ(samples("ball"), 0u);
  simulator_.step(30);
  EXPECT_TRUE(waitFor([&] { return samples("globe") > before; }));
  rename("globe", "ball");
  EXPECT_TRUE(waitFor([&] { return plots.plots().front()->bodies() == QStringList("ball"); }));
}

TEST_F(PlotsPanelTest, FollowsBodiesThatSwapTheirNames) {
  PlotStack& plots = plotHeights({"ball", "crate"});
  const auto height = [&](const QString& body) {
    return plots.history().present("height of " + body.toStdString()).valueAt(1e9).value_or(NAN);
  };
  ASSERT_TRUE(waitFor([&] { return std::isfinite(height("ball")) && std::isfinite(height("crate")); }));
  const double ball = height("ball"), crate = height("crate");
  ASSERT_NE(ball, crate);
  plots.hold(true);
  for (const QStringList& bodies : {QStringList({"crate", "ball"}), QStringList({"ball", "crate"})}) {
    rename("ball", "third");  // which the panel may not see: it hears of the last edit
    rename("crate", "ball");
    rename("third", "crate");
    EXPECT_TRUE(waitFor([&] { return plots.plots().front()->bodies() == bodies; }));
    for (const bool held : {true, false}) {
      plots.hold(held);
      EXPECT_EQ(height(bodies[0]), ball);
      EXPECT_EQ(height(bodies[1]), crate);
    }
    plots.hold(true);
  }
  plots.hold(false);
}

TEST(BodyRenamesTest, AFileThatNumbersItsBodiesOtherwiseHasTheSameBodies) {
  const auto bodies = [](const std::vector<std::pair<const char*, double>>& named) {
    rigid_body_sim::BodyDescriptions descriptions;
    for (const auto& [name, mass] : named) {
      descriptions.bodies.emplace_back();
      descriptions.bodies.back().id = descriptions.bodies.size();
      descriptions.bodies.back().name = name;
      descriptions.bodies.back().mass = mass;
    }
    return descriptions;
  };
  const auto before = bodies({{"a", 1.0}, {"b", 2.0}});
  const QHash<QString, QString> swapped = {{"a", "b"}, {"b", "a"}}, renamed = {{"a", "c"}},
                                passed_on = {{"a", "c"}, {"b", "a"}};
  EXPECT_EQ(renamesOf(before, bodies({{"b", 1.0}, {"a", 2.0}})), swapped);
  EXPECT_EQ(renamesOf(before, bodies({{"c", 1.0}, {"b", 2.0}})), renamed);
  EXPECT_EQ(renamesOf(before, bodies({{"c", 1.0}, {"a", 2.0}})), passed_on);
  EXPECT_TRUE(renamesOf(before, bodies({{"b", 2.0}, {"a", 1.0}})).isEmpty()) << "in another order";
  EXPECT_TRUE(
      renamesOf(bodies({{"a", 1.0}, {"b", 1.0}}), bodies({{"c", 1.0}, {"a", 1.0}, {"b", 1.0}})).isEmpty())
      << "with one more, before the others";
}

TEST_F(PlotsPanelTest, ItsKeysAreListedUnderHelp) {
  QMainWindow window;
  window.menuBar()->addMenu("&Help");
  offerShortcuts(window, window);
  window.findChild<QAction*>(kShortcutsName)->trigger();
  const QString keys = window.findChild<QMessageBox*>()->text();
  int count = 0;
  for (const QToolButton* const button : panel_.findChildren<QToolButton*>()) {
    const QString key = button->shortcut().toString();
    if (key.isEmpty()) continue;
    EXPECT_TRUE(keys.contains(key)) << key.toStdString();
    ++count;
  }
  EXPECT_EQ(count, 5);
}

// A chart of another simulator would be taken for that of this one.
TEST_F(PlotsPanelTest, ForgetsTheChartOfAnotherSimulator) {
  AccuracyPlot& chart = openAccuracy();
  simulator_.measureAccuracy();
  ASSERT_TRUE(waitFor([&] { return chart.isVisible(); }));
  auto& node = *panel_.findChild<NodeBox*>();
  node.setNode("/nobody");
  Q_EMIT node.chosen("/nobody");
  EXPECT_FALSE(chart.isVisible());
  EXPECT_FALSE(panel_.findChild<AccuracyView*>()->isEnabled());
}

// The tooltip of an event's line says what the event was. Elsewhere in the plot there is no tooltip.
TEST(TimePlotTest, ALineTellsWhatHappened) {
  const Quantity& quantity = quantities().front();
  History history;
  for (const double time : {0.0, 10.0}) history.add(quantity.curves.front(), {time, 1.0});
  history.mark(4.0, "wind on");
  history.mark(4.0, "ball: friction 0.2");
  TimePlot plot(quantity, {});
  plot.resize(500, 200);
  plot.setVisible(true);
  plot.show(history, {0.0, 10.0, {}, nullptr});
  plot.replot();
  const auto toldAt = [&](double time) {
    const QPoint at(static_cast<int>(std::lround(plot.transform(QwtPlot::xBottom, time))), 50);
    QHelpEvent help(QEvent::ToolTip, at, plot.canvas()->mapToGlobal(at));
    QApplication::sendEvent(plot.canvas(), &help);
    return QToolTip::text();
  };
  EXPECT_EQ(toldAt(2.0), "");
  EXPECT_EQ(toldAt(4.0), "4.000 s: wind on\nball: friction 0.2");
  EXPECT_TRUE(waitFor([&] { return toldAt(6.0).isEmpty(); }));  // it fades
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "plots_panel_test");
  QApplication application(argc, argv);
  return RUN_ALL_TESTS();
}
