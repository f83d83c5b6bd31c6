// SPDX-License-Identifier: BSD-3-Clause
// The slider of a replay, by mouse and keys, beside a replay of a bag that is made here; without a screen.
#include "wait_for.h"

#include "bodies_client.h"
#include "body_properties.h"
#include "body_table.h"
#include "seek_bar.h"
#include "transport_bar.h"

#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyStates.h>
#include <ros/ros.h>
#include <rosbag/bag.h>

#include <QApplication>
#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace rbs;
using rbs::test::waitFor;

namespace {

constexpr double kStep = 0.02;  // s
constexpr int kStates = 501;    // 10 s of them

// A body that moves by 1 m/s along x.
void writeBag(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  rigid_body_sim::BodyDescriptions descriptions;
  descriptions.bodies.resize(1);
  descriptions.bodies[0].id = 1;
  rigid_body_sim::BodyStates states;
  states.ids = {1};
  states.poses.resize(1);
  states.twists.resize(1);
  rigid_body_sim::Status status;
  status.step = kStep;
  for (int k = 0; k < kStates; ++k) {
    const ros::Time now(1.0 + kStep * k);
    descriptions.header.stamp = states.header.stamp = status.header.stamp = now;
    if (k == 0) bag.write("/sim/body_descriptions", now, descriptions);
    states.poses[0].position.x = status.time = kStep * k;
    bag.write("/sim/body_states", now, states);
    if (k % 5 == 0) bag.write("/sim/status", now, status);
  }
}

class ReplayPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    const QString bag = folder_.filePath("made.bag");
    writeBag(bag.toStdString());
    player_.setProcessChannelMode(QProcess::ForwardedChannels);
    player_.start("rosrun",
                  {"rigid_body_sim", "replay_node", "__name:=player", "_paused:=true", "_bag:=" + bag});
    QObject::connect(&simulator_, &SimulatorClient::statusReceived,
                     [this](const rigid_body_sim::Status& status) { status_ = status; });
    QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar_, &TransportBar::show);
    QObject::connect(&simulator_, &SimulatorClient::reported, [this](const QString& text, bool is_trouble) {
      told_ += is_trouble ? text : QString();
    });
    simulator_.follow("/sim");
    states_ = node_.subscribe("/sim/body_states", 10, &ReplayPanelTest::receive, this);
    bar_.resize(500, 100);
    bar_.setVisible(true);
    ASSERT_TRUE(waitFor([this] { return slider().isVisible() && slider().maximum() > 0; }));
  }
  void TearDown() override {
    player_.terminate();
    player_.waitForFinished();
  }
  void receive(const rigid_body_sim::BodyStates& states) { x_ = states.poses.at(0).position.x; }
  QSlider& slider() { return *bar_.findChild<SeekBar*>()->findChild<QSlider*>(); }
  QString times() { return bar_.findChild<SeekBar*>()->findChildren<QLabel*>().last()->text(); }
  /// Waits until this time is shown by the replay, its status and the slider.
  bool isAt(double time) {
    return waitFor([this, time] {
      return std::abs(x_ - time) < 1.5 * kStep && std::abs(status_.recording.at(0) - time) < kStep &&
             std::abs(1e-4 * slider().value() - time) < kStep;
    });
  }

  QTemporaryDir folder_;
  QProcess player_;
  ros::NodeHandle node_;
  ros::Subscriber states_;
  SimulatorClient simulator_;
  TransportBar bar_{simulator_};
  rigid_body_sim::Status status_;
  QString told_;
  double x_ = -1.0;
};

TEST_F(ReplayPanelTest, SeeksByMouseAndKeys) {
  EXPECT_EQ(slider().maximum(), 100'000);
  EXPECT_EQ(times(), "0:00.00 of 0:10.00");
  QTest::mouseClick(&slider(), Qt::LeftButton, {}, slider().rect().center());
  EXPECT_TRUE(waitFor([this] { return std::abs(x_ - 5.0) < 0.3; })) << x_;
  slider().setFocus();
  QTest::keyClick(&slider(), Qt::Key_Home);
  EXPECT_TRUE(isAt(0.0)) << x_;
  QTest::keyClick(&slider(), Qt::Key_PageUp);
  EXPECT_TRUE(isAt(1.0)) << x_;
  for (int k = 0; k < 10; ++k) QTest::keyClick(&slider(), Qt::Key_Right);
  EXPECT_TRUE(isAt(1.2)) << x_;
  QTest::keyClick(&slider(), Qt::Key_Left);
  EXPECT_TRUE(isAt(1.18)) << x_;
  EXPECT_EQ(times(), "0:01.18 of 0:10.00");
  QTest::keyClick(&slider(), Qt::Key_End);
  EXPECT_TRUE(isAt(10.0)) << x_;
  EXPECT_EQ(told_, "");
}

TEST_F(ReplayPanelTest, SeeksWhileTheSliderIsDraggedAndStaysWhereItIsLetGo) {
  const QPoint middle = slider().rect().center();
  QTest::mousePress(&slider(), Qt::LeftButton, {}, QPoint(10, middle.y()));
  double last = -1.0;
  for (int x = 20; x < slider().width() - 20; x += 5) {
    QTest::mouseMove(&slider(), QPoint(x, middle.y()));
    QMouseEvent move(QEvent::MouseMove, QPoint(x, middle.y()), Qt::NoButton, Qt::LeftButton, Qt::NoModifier);
    QApplication::sendEvent(&slider(), &move);
  }
  last = 1e-4 * slider().value();
  EXPECT_GT(last, 8.0);
  EXPECT_TRUE(waitFor([&] { return std::abs(x_ - last) < 1.5 * kStep; })) << x_;  // also while it is down
  QTest::mouseRelease(&slider(), Qt::LeftButton, {}, QPoint(slider().width() - 20, middle.y()));
  EXPECT_TRUE(isAt(1e-4 * slider().value()));
  EXPECT_EQ(told_, "");
}

TEST_F(ReplayPanelTest, PlaysAndMovesTheSliderAndCannotRecord) {
  EXPECT_FALSE(bar_.findChild<QToolButton*>("record")->isEnabled());
  bar_.record();
  EXPECT_FALSE(bar_.isRecording());
  bar_.playOrPause();
  EXPECT_TRUE(waitFor([this] { return !status_.paused && slider().value() > 5'000 && x_ > 0.5; }));
  bar_.playOrPause();
  EXPECT_TRUE(waitFor([this] { return status_.paused; }));
  const double before = status_.recording.at(0);
  bar_.step();
  EXPECT_TRUE(waitFor([&] { return status_.recording.at(0) > before; }));
  EXPECT_LT(status_.recording.at(0), before + 1.5 * kStep);
}

TEST_F(ReplayPanelTest, BodiesAreReadAndNotChanged) {
  BodiesClient bodies;
  BodyProperties form(bodies);
  const BodyTable table(bodies);
  form.setVisible(true);
  bodies.follow("/sim");
  ASSERT_TRUE(waitFor([&] { return bodies.bodies().size() == 1 && bodies.isReplay(); }));
  const QString name = QString::fromStdString(bodies.bodies()[0].name);
  ASSERT_TRUE(waitFor([&] {
    bodies.select({name});
    return bodies.selection() == QStringList{name};
  }));
  form.choose({name}, {});
  EXPECT_FALSE(table.flags(table.index(0, BodyTable::Name)) & Qt::ItemIsEditable);
  const QList<ValueField*> fields = form.findChildren<ValueField*>();
  ASSERT_GT(fields.size(), 10);
  ASSERT_TRUE(waitFor([&] { return fields[0]->text() == name; }));
  for (const ValueField* const field : fields) EXPECT_FALSE(field->isEnabled()) << qPrintable(field->text());
  EXPECT_FALSE(form.findChild<QComboBox*>()->isEnabled());
  const auto position = [&] {
    const auto x = std::find_if(fields.begin(), fields.end(),
                                [](ValueField* field) { return field->accessibleName() == "Position x"; });
    return x == fields.end() ? std::nan("") : (*x)->text().toDouble();
  };
  QTest::keyClick(&slider(), Qt::Key_End);
  EXPECT_TRUE(waitFor([&] { return std::abs(position() - 10.0) < 1.5 * kStep; })) << position();
  bodies.follow("/nobody");
  EXPECT_FALSE(bodies.isReplay());
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "replay_panel_test", ros::init_options::NoSigintHandler);
  QApplication application(argc, argv);
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
