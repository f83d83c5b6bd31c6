// SPDX-License-Identifier: BSD-3-Clause
// The chart of the panel: its points are named, can be taken while they hold for the scene, and the live one
// is there.
#include "accuracy_plot.h"

#include <qwt_legend_data.h>
#include <qwt_symbol.h>

#include <QApplication>
#include <QMouseEvent>

#include <gtest/gtest.h>

using namespace rbs;

namespace {

rigid_body_sim::SettingCost cost(const char* name, const char* preset, double step_ms, double error) {
  rigid_body_sim::SettingCost cost;
  cost.name = name;
  cost.preset = preset;
  cost.step_ms = step_ms;
  cost.error = error;
  return cost;
}

rigid_body_sim::AccuracyStudy study() {
  rigid_body_sim::AccuracyStudy study;
  study.scene = "playground";
  study.windows = 1;
  study.settings = {cost("preview", "preview", 0.01, 0.1),
                    cost("interactive, 2 divisions", "interactive", 0.1, 0.01),
                    cost("reference", "reference", 1.0, 1e-6)};
  study.settings.back().at_most = true;
  return study;
}

struct Chart {
  AccuracyPlot plot;
  QString chosen;

  Chart() {
    QObject::connect(&plot, &AccuracyPlot::chosen, [this](const rigid_body_sim::SettingCost& cost) {
      chosen = QString::fromStdString(cost.name);
    });
  }
  void show(const rigid_body_sim::AccuracyStudy& study) {
    plot.show(study);
    plot.resize(400, 200);
    plot.updateLayout();
    plot.replot();
    QApplication::processEvents();
  }
  QPoint pixelsOf(double step_ms, double error) const {
    return {int(plot.transform(QwtPlot::xBottom, step_ms)), int(plot.transform(QwtPlot::yLeft, error))};
  }
  void click(const QPoint& at) {
    for (const QEvent::Type type : {QEvent::MouseButtonPress, QEvent::MouseButtonRelease}) {
      QMouseEvent event(type, at, Qt::LeftButton, Qt::LeftButton, Qt::NoModifier);
      QApplication::sendEvent(plot.canvas(), &event);
    }
  }
};

TEST(AccuracyPlot, NamesThePointUnderTheMouse) {
  Chart chart;
  chart.show(study());
  EXPECT_EQ(chart.plot.nameAt(chart.pixelsOf(0.1, 0.01)),
            "interactive, 2 divisions:\n0.1 ms, 10 mm/s\nclick to take it");
  EXPECT_EQ(chart.plot.nameAt(chart.pixelsOf(1.0, 1e-6)),
            "reference:\n1 ms, at most 1 µm/s\nclick to take it");
  EXPECT_EQ(chart.plot.nameAt(chart.pixelsOf(1.0, 0.1)), "");
}

TEST(AccuracyPlot, NamesThePresetsAndTheLiveSimulationInALegend) {
  Chart chart;
  chart.show(study());
  QStringList names;
  for (const QwtPlotItem* item : chart.plot.itemList(QwtPlotItem::Rtti_PlotCurve))
    if (item->testItemAttribute(QwtPlotItem::Legend)) names << item->title().text();
  EXPECT_EQ(names, QStringList({"preview", "interactive", "accurate", "reference", "live"}));
  EXPECT_NE(chart.plot.legend(), nullptr);
}

TEST(AccuracyPlot, AClickTakesASettingWhileItHolds) {
  Chart chart;
  chart.show(study());
  chart.click(chart.pixelsOf(0.01, 0.1));
  EXPECT_EQ(chart.chosen, "preview");
  chart.chosen.clear();
  rigid_body_sim::AccuracyStudy stale = study();
  stale.stale = "'tower' was loaded";
  chart.show(stale);
  chart.click(chart.pixelsOf(0.01, 0.1));
  EXPECT_EQ(chart.chosen, "");
  EXPECT_EQ(chart.plot.nameAt(chart.pixelsOf(0.01, 0.1)), "preview:\n0.01 ms, 100 mm/s");
}

TEST(AccuracyPlot, IsHiddenWhileNothingIsKnown) {
  Chart chart;
  chart.show(rigid_body_sim::AccuracyStudy());
  EXPECT_TRUE(chart.plot.isHidden());
  chart.plot.showLive(0.5, 0.01);
  chart.show(study());
  EXPECT_FALSE(chart.plot.isHidden());
}

// The theme of the desktop may change while the chart is shown.
TEST(AccuracyPlot, FollowsThePalette) {
  Chart chart;
  chart.show(study());
  const auto colorOf = [&](int k) {
    const QwtPlotItemList curves = chart.plot.itemList(QwtPlotItem::Rtti_PlotCurve);
    return static_cast<QwtPlotCurve*>(curves.at(k))->symbol()->brush().color();
  };
  QPalette dark;
  dark.setColor(QPalette::Base, Qt::black);
  dark.setColor(QPalette::Text, Qt::white);
  const QColor before = colorOf(1);
  chart.plot.setPalette(dark);
  EXPECT_EQ(chart.plot.canvasBackground().color(), QColor(Qt::black));
  EXPECT_GT(colorOf(1).lightness(), before.lightness()) << "to stand out from the dark";
}

}  // namespace

int main(int argc, char** argv) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  QApplication application(argc, argv);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
