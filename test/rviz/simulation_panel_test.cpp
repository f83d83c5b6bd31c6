// SPDX-License-Identifier: BSD-3-Clause
// The pages of the panel of the simulation, by keys and mouse, beside a running simulator; without a screen.
#include "wait_for.h"

#include "effects_view.h"
#include "hearing.h"
#include "icons.h"
#include "node_box.h"
#include "pipeline_tree.h"
#include "scene_bar.h"
#include "scene_list.h"
#include "status_view.h"
#include "step_view.h"
#include "transport_bar.h"
#include "warnings_view.h"
#include "wind_view.h"

#include <rigid_body_sim/LoadScene.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>

#include <QApplication>
#include <QDir>
#include <QFile>
#include <QFileDialog>
#include <QImage>
#include <QLineEdit>
#include <QMenu>
#include <QMessageBox>
#include <QPainter>
#include <QShortcut>
#include <QTemporaryDir>
#include <QTest>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace rbs;
using rbs::test::waitFor;

namespace {

class SimulationPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    QObject::connect(&simulator_, &SimulatorClient::statusReceived,
                     [this](const rigid_body_sim::Status& status) { status_ = status; });
    QObject::connect(&simulator_, &SimulatorClient::windReceived,
                     [this](const rigid_body_sim::Wind& wind) { wind_ = wind; });
    QObject::connect(&simulator_, &SimulatorClient::reported,
                     [this](const QString& text, bool) { told_ = text; });
    simulator_.follow("/sim");
    simulator_.loadScene(scene());
    ASSERT_TRUE(waitFor([this] { return !status_.scene.empty() && status_.time == 0.0 && !status_.wind; }));
  }

  static QString scene() {
    return QString::fromStdString(ros::package::getPath("rigid_body_sim")) + "/test/node/small.yaml";
  }
  template <class Widget>
  static Widget& child(QWidget& parent, int k = 0) {
    return *parent.findChildren<Widget*>().at(k);
  }
  static QToolButton& recordButton(TransportBar& bar) { return *bar.findChild<QToolButton*>("record"); }
  static QDoubleSpinBox& speedBox(TransportBar& bar) { return child<QDoubleSpinBox>(bar, 1); }
  /// What the box says below itself; empty while it says nothing.
  static QString refusal(QDoubleSpinBox& box) {
    QLabel& label = child<QLabel>(box);
    return label.isVisible() ? label.text() : QString();
  }
  static void enter(QDoubleSpinBox& box, const char* text) {
    box.setFocus();
    box.selectAll();
    QTest::keyClicks(&box, text);
    QTest::keyClick(&box, Qt::Key_Return);
    box.clearFocus();
  }

  SimulatorClient simulator_;
  rigid_body_sim::Status status_;
  rigid_body_sim::Wind wind_;
  QString told_;
};

TEST_F(SimulationPanelTest, SetsTheWindByDirectionSpeedAndGusts) {
  WindView view(simulator_);
  view.setVisible(true);
  QList<QDoubleSpinBox*> boxes = view.findChildren<QDoubleSpinBox*>();  // in the order of the form
  ASSERT_EQ(boxes.size(), 4);
  enter(*boxes[1], "8");
  ASSERT_TRUE(waitFor([this] { return wind_.enabled && wind_.mean.x == 8.0; }));
  enter(*boxes[0], "90");
  EXPECT_TRUE(
      waitFor([this] { return std::abs(wind_.mean.y - 8.0) < 1e-12 && std::abs(wind_.mean.x) < 1e-12; }));
  enter(*boxes[2], "-2");
  EXPECT_TRUE(waitFor([this] { return wind_.mean.z == -2.0; }));
  enter(*boxes[3], "1.5");
  EXPECT_TRUE(waitFor([this] { return wind_.gust == 1.5; }));
  enter(*boxes[3], "2,5");
  EXPECT_TRUE(waitFor([this] { return wind_.gust == 2.5; })) << "a decimal comma: " << wind_.gust;
  child<QDial>(view).setValue(0);  // down: to -y
  EXPECT_TRUE(waitFor([this] { return std::abs(wind_.mean.y + 8.0) < 1e-9; }));
  EXPECT_TRUE(waitFor([&] { return boxes[0]->value() == 270.0; }));
  EXPECT_EQ(wind_.mean.z, -2.0);
}

TEST_F(SimulationPanelTest, ShowsNoWindOfTheSceneBefore) {
  WindView view(simulator_);
  view.setVisible(true);
  const QList<QDoubleSpinBox*> boxes = view.findChildren<QDoubleSpinBox*>();
  enter(*boxes[1], "8");
  enter(*boxes[2], "-2");
  enter(*boxes[3], "1.5");
  ASSERT_TRUE(waitFor([this] { return wind_.enabled && wind_.gust == 1.5; }));
  simulator_.loadScene(scene());
  ASSERT_TRUE(waitFor([this] { return !wind_.enabled; }));
  for (const int box : {1, 2, 3}) EXPECT_EQ(boxes[box]->value(), 0.0) << box;
}

TEST_F(SimulationPanelTest, TurnsTheWindByTheCompass) {
  WindView view(simulator_);
  view.resize(400, 200);
  view.setVisible(true);
  enter(*view.findChildren<QDoubleSpinBox*>()[1], "8");
  ASSERT_TRUE(waitFor([this] { return wind_.enabled && wind_.mean.x == 8.0; }));
  QDial& compass = child<QDial>(view);
  QTest::mouseClick(&compass, Qt::LeftButton, {}, QPoint(compass.width() / 2, compass.height() / 4));
  EXPECT_TRUE(waitFor([this] { return wind_.mean.y > 7.9; })) << "up is y";
  const int before = compass.value();
  compass.setFocus();
  QTest::keyClick(&compass, Qt::Key_PageUp);
  EXPECT_GT(compass.value(), before);
  EXPECT_TRUE(waitFor([this] { return wind_.mean.x > 0.5 && wind_.mean.y > 0.0; })) << "clockwise, towards x";
}

TEST_F(SimulationPanelTest, SwitchesEffectsAndTellsWhatThatNeglects) {
  EffectsView view(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &view, &EffectsView::show);
  const auto choose = [&](const char* effect, const char* mode) {
    for (QComboBox* const box : view.findChildren<QComboBox*>()) {
      if (box->accessibleName() != effect) continue;
      box->setCurrentText(mode);
      Q_EMIT box->activated(box->currentIndex());
    }
  };
  const auto why = [&](int row) { return view.topLevelItem(row)->text(3); };
  choose("gravity", "off");
  ASSERT_TRUE(waitFor([this] { return status_.forced_off == std::vector<std::string>{"gravity"}; }));
  EXPECT_TRUE(waitFor([&] { return why(0).contains("without gravity"); })) << why(0).toStdString();
  choose("rolling", "on");
  ASSERT_TRUE(waitFor([this] { return status_.forced_on == std::vector<std::string>{"rolling"}; }));
  choose("gravity", "auto");
  choose("rolling", "auto");
  ASSERT_TRUE(waitFor([this] { return status_.forced_off.empty() && status_.forced_on.empty(); }));
  EXPECT_TRUE(waitFor([&] { return why(0).contains("9.81"); })) << why(0).toStdString();
  choose("sleeping", "on");
  ASSERT_TRUE(waitFor([this] { return status_.forced_on == std::vector<std::string>{"sleeping"}; }));
  choose("sleeping", "auto");
  ASSERT_TRUE(waitFor([this] { return status_.forced_on.empty(); }));
}

TEST_F(SimulationPanelTest, SavesAndOpensFilesAndOffersThemAgain) {
  SceneBar bar(simulator_);
  const QTemporaryDir folder;
  const QString file = folder.filePath("kept.yaml");
  simulator_.saveScene(file);
  ASSERT_TRUE(waitFor([&] { return bar.recent() == QStringList{file}; })) << told_.toStdString();
  EXPECT_TRUE(QFile::exists(file));
  const QString state = folder.filePath("state.yaml");
  simulator_.saveState(state);
  ASSERT_TRUE(waitFor([&] { return bar.recent() == QStringList({"state:" + state, file}); }));
  simulator_.loadScene(file);
  ASSERT_TRUE(waitFor([&] { return bar.recent() == QStringList({file, "state:" + state}); }));
  simulator_.loadState(file);  // which holds no state
  EXPECT_TRUE(waitFor([this] { return told_.contains("open it as a scene"); })) << told_.toStdString();
  EXPECT_EQ(bar.recent(), QStringList({file, "state:" + state}));
  simulator_.saveScene("/proc/no.yaml");
  EXPECT_TRUE(waitFor([this] { return told_.contains("/proc: "); })) << told_.toStdString();
}

// Save writes over a file only what came from it.
TEST_F(SimulationPanelTest, SavesNoOtherSceneOverAFile) {
  SceneBar bar(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar, &SceneBar::show);
  const QTemporaryDir folder;
  const auto saved = [&](const char* name) {
    const QString file = folder.filePath(name);
    simulator_.saveScene(file);
    ASSERT_TRUE(waitFor([&] { return bar.recent().value(0) == file; })) << told_.toStdString();
  };
  const auto save = [&] {
    Q_EMIT child<QToolButton>(bar).menu()->aboutToShow();
    for (QAction* const action : child<QToolButton>(bar).menu()->actions())
      if (action->text().startsWith("Save scene to ") && action->isEnabled()) return action->text().mid(14);
    return QString();
  };
  // Longer than a status may be on its way.
  const auto settles = [&] {
    QElapsedTimer time;
    time.start();
    return waitFor([&] { return time.elapsed() > 1500; });
  };
  const auto others = [](const std::string& scene) {
    rigid_body_sim::LoadScene load;
    load.request.name = scene;
    ASSERT_TRUE(ros::service::call("/sim/load_scene", load));
    ASSERT_TRUE(load.response.success) << load.response.message;
  };
  saved("s.yaml");
  ASSERT_TRUE(settles());
  EXPECT_EQ(save(), "s.yaml");
  simulator_.enableWind(true);
  ASSERT_TRUE(waitFor([this] { return status_.wind; }));
  simulator_.undo();
  ASSERT_TRUE(waitFor([this] { return !status_.wind; }));
  EXPECT_EQ(save(), "s.yaml") << "the same scene, without the wind";
  simulator_.reset();
  ASSERT_TRUE(settles());
  EXPECT_EQ(save(), "s.yaml");
  const std::uint64_t before = status_.world;
  others(folder.filePath("s.yaml").toStdString());  // of the same name
  ASSERT_TRUE(waitFor([&] { return status_.world > before; }));
  EXPECT_EQ(save(), "");

  simulator_.loadScene(folder.filePath("s.yaml"));
  ASSERT_TRUE(settles());
  EXPECT_EQ(save(), "s.yaml");
  simulator_.undo();  // of the load
  ASSERT_TRUE(waitFor([&] { return status_.redo.substr(0, 6) == "loaded"; }));
  EXPECT_EQ(save(), "");

  // Also at once, while a status of before the load may be on its way.
  simulator_.enableWind(true);  // so that there is nothing to redo
  ASSERT_TRUE(waitFor([this] { return status_.wind; }));
  simulator_.loadScene(folder.filePath("s.yaml"));
  ASSERT_TRUE(waitFor([&] { return save() == "s.yaml"; }));
  simulator_.undo();
  ASSERT_TRUE(waitFor([&] { return status_.redo.substr(0, 6) == "loaded"; }));
  EXPECT_EQ(save(), "");
}

// The name in the file is that of a scene of the catalogue.
TEST_F(SimulationPanelTest, ShowsAFileByItsOwnName) {
  SceneBar bar(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar, &SceneBar::show);
  QComboBox& scenes = child<QComboBox>(bar);
  const auto shown = [&] {
    return scenes.currentIndex() < 0 ? scenes.placeholderText() : scenes.currentText();
  };
  simulator_.loadScene("marbles");
  ASSERT_TRUE(waitFor([&] { return shown() == "marbles"; }));
  const QTemporaryDir folder;
  simulator_.saveScene(folder.filePath("kept.yaml"));
  EXPECT_TRUE(waitFor([&] { return shown() == "kept.yaml"; })) << shown().toStdString();
  simulator_.loadScene("marbles");
  EXPECT_TRUE(waitFor([&] { return shown() == "marbles"; })) << shown().toStdString();
  simulator_.loadScene(folder.filePath("kept.yaml"));
  EXPECT_TRUE(waitFor([&] { return shown() == "kept.yaml"; })) << shown().toStdString();
}

TEST_F(SimulationPanelTest, AsksBeforeALoadDropsEdits) {
  SceneBar bar(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar, &SceneBar::show);
  QComboBox& scenes = child<QComboBox>(bar);
  ASSERT_TRUE(waitFor([&] { return scenes.findText("marbles") >= 0; }));
  const auto choose = [&](const char* scene) {
    scenes.setCurrentText(scene);
    Q_EMIT scenes.activated(scenes.currentIndex());
    return bar.findChild<QMessageBox*>();
  };
  EXPECT_EQ(choose("marbles"), nullptr) << "nothing is lost";
  ASSERT_TRUE(waitFor([this] { return status_.scene == "marbles"; }));
  const std::string loaded = status_.scene;
  simulator_.enableWind(true);
  ASSERT_TRUE(waitFor([this] { return status_.unsaved && status_.wind; }));
  QMessageBox* question = choose("pyramid");
  ASSERT_TRUE(question);
  question->button(QMessageBox::Cancel)->click();
  EXPECT_EQ(scenes.currentText(), "marbles");
  EXPECT_TRUE(waitFor([&] { return !bar.findChild<QMessageBox*>(); }));
  EXPECT_EQ(status_.scene, loaded);
  question = choose("pyramid");
  ASSERT_TRUE(question);
  question->button(QMessageBox::Open)->click();
  EXPECT_TRUE(waitFor([this] { return status_.scene == "pyramid"; }));
}

// The dialog has asked about the name as it was typed; the simulator adds the suffix.
TEST_F(SimulationPanelTest, ReplacesNoFileThatNobodyWasAskedAbout) {
  const QTemporaryDir folder;
  const QString file = folder.filePath("lab.v2.yaml");
  QFile kept(file);
  ASSERT_TRUE(kept.open(QIODevice::WriteOnly));
  kept.write("mine");
  kept.close();
  simulator_.saveScene(folder.filePath("lab.v2"));
  EXPECT_TRUE(waitFor([this] { return told_.contains("save_scene"); })) << told_.toStdString();
  ASSERT_TRUE(kept.open(QIODevice::ReadOnly));
  EXPECT_EQ(kept.readAll(), QByteArray("mine"));
}

// The first is under way: its answer comes. What waits is given up, and said to be.
TEST_F(SimulationPanelTest, GivesUpCallsThatHaveNotBegun) {
  int calls = 0;
  ros::NodeHandle node;
  const boost::function<bool(std_srvs::Trigger::Request&, std_srvs::Trigger::Response&)> serve =
      [&](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
        ++calls;
        response.success = true;
        return true;
      };
  const ros::ServiceServer server = node.advertiseService("slow", serve);
  ServiceWorker worker;
  QStringList answers;
  QObject::connect(&worker, &ServiceWorker::answered,
                   [&](const QString&, bool, const QString& text) { answers.append(text); });
  int refused = 0;
  for (int k = 0; k < 4; ++k)
    worker.call<std_srvs::Trigger>(node.resolveName("slow"), {}, {}, [&](const QString&) { ++refused; });
  QTest::qSleep(500);  // the first is under way, and nobody serves it yet
  worker.dropWaiting("given up");
  EXPECT_EQ(answers, QStringList({"given up", "given up", "given up"}));
  EXPECT_EQ(refused, 3);
  ASSERT_TRUE(waitFor([&] { return answers.size() == 4; }));
  EXPECT_EQ(calls, 1);
  EXPECT_EQ(refused, 3);
  worker.call<std_srvs::Trigger>(node.resolveName("slow"), {});
  EXPECT_TRUE(waitFor([&] { return calls == 2 && answers.size() == 5; }));
}

TEST_F(SimulationPanelTest, AsksForAFileByTheMenu) {
  SceneBar bar(simulator_);
  bar.setVisible(true);
  const QTemporaryDir folder;
  const auto choose = [&bar](const QString& entry, const QString& file) {
    auto& files = child<QToolButton>(bar);
    Q_EMIT files.menu()->aboutToShow();
    for (QAction* const action : files.menu()->actions())
      if (action->text() == entry) action->trigger();
    auto* const dialog = bar.findChild<QFileDialog*>();
    ASSERT_TRUE(dialog) << entry.toStdString();
    auto& name = *dialog->findChild<QLineEdit*>("fileNameEdit");
    name.clear();
    QTest::keyClicks(&name, file);
    QTest::keyClick(&name, Qt::Key_Return);
    ASSERT_TRUE(waitFor([&] { return !bar.findChild<QFileDialog*>(); }));
  };
  choose("Save scene as…", folder.filePath("kept"));  // the suffix is added
  EXPECT_TRUE(waitFor([&] { return QFile::exists(folder.filePath("kept.yaml")); })) << told_.toStdString();
  choose("Open scene…", folder.filePath("kept.yaml"));
  EXPECT_TRUE(waitFor([&] { return bar.recent().contains(folder.filePath("kept.yaml")); }));
  EXPECT_TRUE(waitFor([this] { return told_.contains("kept.yaml") || told_.contains("loaded"); }))
      << told_.toStdString();
}

// Letters only add ink, until an ellipsis takes the place of some: what does not fit is not cut in silence.
TEST(SceneList, EndsInAnEllipsisWhereThereIsMoreThanFits) {
  QComboBox box;
  showAsSceneList(box);
  const auto drawn = [&box](int letters) {
    fillSceneList(box, {"scene"}, {QString(letters, 'i')});  // narrower than an ellipsis
    QImage picture(box.itemDelegate()->sizeHint({}, {}), QImage::Format_RGB32);
    picture.fill(Qt::white);
    QPainter painter(&picture);
    QStyleOptionViewItem option;
    option.rect = picture.rect();
    box.itemDelegate()->paint(&painter, option, box.model()->index(0, 0));
    return picture;
  };
  const auto losesInk = [](const QImage& before, const QImage& after) {
    for (int y = 0; y < before.height(); ++y)
      for (int x = 0; x < before.width(); ++x)
        if (before.pixel(x, y) != before.pixel(0, 0) && after.pixel(x, y) == before.pixel(0, 0)) return true;
    return false;
  };
  int letters = 1;
  while (letters < 1000 && !losesInk(drawn(letters), drawn(letters + 1))) ++letters;
  EXPECT_GT(letters, 50) << "there is room for some";
  EXPECT_LT(letters, 1000) << "no ellipsis";
  EXPECT_EQ(drawn(letters + 1), drawn(letters + 50)) << "the rest is left out";
}

// On a screen with two pixels a point, an icon of pixels would be blurred.
TEST(Icons, AreDrawnInTheSizeThatIsAskedFor) {
  const QImage small = playIcon().pixmap(18, 18).toImage(), large = playIcon().pixmap(72, 72).toImage();
  ASSERT_EQ(large.size(), QSize(72, 72));
  EXPECT_EQ(small.size(), QSize(18, 18));
  const auto partial = [](const QImage& image) {  // pixels on the rim, neither in nor out
    int count = 0;
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x) {
        const int alpha = qAlpha(image.pixel(x, y));
        count += alpha > 8 && alpha < 247;
      }
    return count;
  };
  EXPECT_LT(partial(large), 6 * partial(small)) << "a blurred rim is an area, a sharp one a line";
}

TEST_F(SimulationPanelTest, PacesBySliderNumberAndKeys) {
  TransportBar bar(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar, &TransportBar::show);
  bar.setVisible(true);
  auto& slider = child<QSlider>(bar);
  ASSERT_TRUE(waitFor([&] { return slider.value() == 40; }));  // real time
  slider.setValue(0);
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 0.01; }));
  slider.setValue(60);
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 10.0; }));
  bar.goFaster();
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 20.0; }));
  bar.goSlower();
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 10.0; }));
  enter(speedBox(bar), "1");
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 1.0; }));
  EXPECT_TRUE(waitFor([&] { return slider.value() == 40; }));
  for (const auto& [text, speed] :
       {std::pair("0.005", 0.005), std::pair("150", 150.0), std::pair("1e9", 150.0), std::pair("0", 0.0),
        std::pair("2,5", 2.5), std::pair("-3", 2.5), std::pair("10000000", 2.5), std::pair("0.1", 0.1)}) {
    enter(speedBox(bar), text);
    EXPECT_TRUE(waitFor([&, speed = speed] { return status_.requested_speed == speed; }))
        << text << ": " << status_.requested_speed;
  }
  enter(speedBox(bar), "0.004");
  ASSERT_TRUE(waitFor([this] { return status_.requested_speed == 0.004; }));
  EXPECT_EQ(speedBox(bar).text(), QString::fromUtf8("0.004 ×"));
  bar.goSlower();
  bar.goFaster();
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 0.008; })) << status_.requested_speed;
  const std::uint64_t before = status_.steps;
  bar.step();
  EXPECT_TRUE(waitFor([&] { return status_.steps == before + 1; }));
}

TEST_F(SimulationPanelTest, SaysWhichNumbersAreNotTakenAndWhatIsAllowed) {
  TransportBar bar(simulator_);
  QObject::connect(&simulator_, &SimulatorClient::statusReceived, &bar, &TransportBar::show);
  bar.setVisible(true);
  QDoubleSpinBox &steps = child<QDoubleSpinBox>(bar), &speed = speedBox(bar);
  enter(speed, "1e9");
  EXPECT_EQ(refusal(speed), QString::fromUtf8("1e9 (allowed: a number such as 1.5, 0 to 1000000 ×)"));
  speed.setFocus();
  QTest::keyClicks(&speed, "2");
  EXPECT_EQ(refusal(speed), "") << "it is over with the next number";
  QTest::keyClick(&speed, Qt::Key_Return);
  EXPECT_EQ(refusal(speed), "");
  enter(speed, "0");
  ASSERT_EQ(speed.text(), "max");
  QTest::keyClick(&speed, Qt::Key_Return);
  EXPECT_EQ(refusal(speed), "") << "what the box itself says is no mistake";
  const std::uint64_t before = status_.steps;
  for (const char* const text : {"5000", "2.5"}) {
    steps.selectAll();
    QTest::keyClicks(&steps, text);
    bar.step();
    EXPECT_EQ(refusal(steps), QString("%1 (allowed: a whole number, 1 to 1000)").arg(text));
    EXPECT_EQ(steps.text(), "1") << text;
  }
  enter(steps, "3");
  bar.step();
  EXPECT_TRUE(waitFor([&] { return status_.steps == before + 3; }))
      << "and no others: " << status_.steps - before;
  WindView view(simulator_);
  view.setVisible(true);
  QDoubleSpinBox& wind = child<QDoubleSpinBox>(view, 1);
  enter(wind, "fast");
  EXPECT_EQ(refusal(wind), "fast (allowed: a number such as 1.5, 0 to 10000 m/s)");
}

TEST_F(SimulationPanelTest, ASecondSpeedIsNoShortcut) {
  TransportBar bar(simulator_);
  bar.setVisible(true);
  QApplication::setActiveWindow(&bar);
  auto& speed = speedBox(bar);
  int keys = 0;
  QShortcut wind(Qt::Key_1, &bar), run(Qt::Key_Space, &bar);
  QObject::connect(&wind, &QShortcut::activated, [&] { ++keys; });
  QObject::connect(&run, &QShortcut::activated, [&] { keys += 10; });
  speed.setFocus();
  speed.selectAll();
  QTest::keyClicks(&speed, "2");
  QTest::keyClick(&speed, Qt::Key_Return);
  ASSERT_TRUE(waitFor([this] { return status_.requested_speed == 2.0; }));
  QTest::keyClicks(QApplication::focusWidget(), "1");
  QTest::keyClick(QApplication::focusWidget(), Qt::Key_Return);
  EXPECT_TRUE(waitFor([this] { return status_.requested_speed == 1.0; })) << status_.requested_speed;
  EXPECT_EQ(keys, 0);
  QTest::keyClick(QApplication::focusWidget(), Qt::Key_Space);
  EXPECT_EQ(keys, 10) << "what is no part of a number is a shortcut";
}

TEST(NodeBox, IsChosenByEnterAlone) {
  NodeBox box;
  box.setNode("sim");
  QStringList chosen;
  QObject::connect(&box, &NodeBox::chosen, [&](const QString& node) { chosen.append(node); });
  QLineEdit& line = *box.lineEdit();
  line.selectAll();
  QTest::keyClicks(&line, "8");
  QFocusEvent leaves(QEvent::FocusOut);
  QApplication::sendEvent(&line, &leaves);
  EXPECT_TRUE(chosen.isEmpty());
  EXPECT_EQ(box.currentText(), "sim");
  line.selectAll();
  QTest::keyClicks(&line, "other");
  QTest::keyClick(&line, Qt::Key_Return);
  EXPECT_EQ(chosen, QStringList("other"));
  EXPECT_EQ(box.node(), "other");
  EXPECT_EQ(box.currentText(), "other");
}

TEST_F(SimulationPanelTest, RecordsByItsButtonAndSaysWhereTheBagIs) {
  const QTemporaryDir folder;
  TransportBar bar(simulator_);
  bar.setVisible(true);
  bar.setFolder(folder.path());
  auto& note = static_cast<ElidedText&>(*bar.recordingNote());
  note.setParent(&bar);
  EXPECT_FALSE(note.isVisible());
  QTest::mouseClick(&recordButton(bar), Qt::LeftButton);
  EXPECT_TRUE(bar.isRecording());
  ASSERT_TRUE(waitFor([&] { return note.text().contains(" MB a minute") || !bar.isRecording(); }))
      << note.text().toStdString();
  EXPECT_TRUE(bar.isRecording());
  EXPECT_TRUE(note.text().startsWith("Recording 0:") && note.text().contains("sim_"))
      << note.text().toStdString();
  QTest::mouseClick(&recordButton(bar), Qt::LeftButton);
  ASSERT_TRUE(waitFor([&] { return !bar.isRecording(); }));
  const QStringList bags = QDir(folder.path()).entryList(QDir::Files);
  ASSERT_EQ(bags.size(), 1);
  EXPECT_TRUE(bags[0].startsWith("sim_") && bags[0].endsWith(".bag")) << bags[0].toStdString();
  EXPECT_TRUE(note.text().startsWith("Recorded ") && note.text().contains(bags[0]))
      << note.text().toStdString();
}

TEST_F(SimulationPanelTest, SaysWhyNothingIsRecorded) {
  TransportBar bar(simulator_);
  bar.setVisible(true);
  bar.setFolder("/nowhere");
  auto& note = static_cast<ElidedText&>(*bar.recordingNote());
  note.setParent(&bar);
  bar.record();
  ASSERT_TRUE(waitFor([&] { return !bar.isRecording(); }));
  EXPECT_TRUE(note.text().contains("there is no folder /nowhere")) << note.text().toStdString();
  const QByteArray path = qgetenv("PATH");
  qputenv("PATH", "/nowhere");
  bar.record();
  ASSERT_TRUE(waitFor([&] { return !bar.isRecording(); }));
  qputenv("PATH", path);
  EXPECT_TRUE(note.text().contains("rosrun cannot be started")) << note.text().toStdString();
}

TEST_F(SimulationPanelTest, EndsTheRecordingWithThePanel) {
  const QTemporaryDir folder;
  const auto isThere = [&](const char* end) {
    const QStringList files = QDir(folder.path()).entryList(QDir::Files);
    return files.size() == 1 && files[0].endsWith(end);
  };
  {
    TransportBar bar(simulator_);
    bar.setFolder(folder.path());
    bar.record();
    ASSERT_TRUE(waitFor([&] { return isThere(".bag.active"); }));
  }
  EXPECT_TRUE(waitFor([&] { return isThere(".bag"); }));
}

TEST(WarningsView, CountsWhatComesAgainAndKeepsABoundedList) {
  WarningsView view;
  rigid_body_sim::Status status;
  view.show(status);
  EXPECT_EQ(view.count(), 0);
  const auto& list = *view.findChild<QTreeWidget*>();
  for (int k = 0; k < 300; ++k) {
    status.time = k;
    status.warnings = {"again", "warning " + std::to_string(k)};
    view.show(status);
  }
  EXPECT_EQ(view.count(), 200);
  EXPECT_EQ(list.topLevelItem(0)->text(2), "warning 299");
  EXPECT_EQ(list.topLevelItem(1)->text(2), "again");
  EXPECT_EQ(list.topLevelItem(1)->text(1), "300");
  status.warnings.clear();
  view.show(status);
  EXPECT_EQ(view.count(), 200);
  ++status.world;  // another scene, whose time and bodies are others
  view.show(status);
  EXPECT_EQ(view.count(), 0);
  status.warnings = {"again"};
  view.show(status);
  EXPECT_EQ(view.count(), 1);
  view.clear();
  EXPECT_EQ(view.count(), 0);
}

// While RViz has a dialog of its own open, Qt goes on and no message comes.
TEST(Hearing, IsNotLostWhileNoMessagesAreTaken) {
  Hearing hearing;
  hearing.hear();
  for (int k = 0; k < 40; ++k) {
    QTest::qWait(100);
    ASSERT_TRUE(hearing.isHeard()) << k;
  }
  EXPECT_TRUE(waitFor([&] { return !hearing.isHeard(); }))
      << "once messages are taken, and none is of the node";
}

TEST(StatusView, ShowsBothEndsOfALongReason) {
  StatusView view;
  view.resize(240, 150);
  view.setVisible(true);
  rigid_body_sim::Status status;
  status.bottleneck =
      "contacts.solve takes the most of a step, which is longer than the time that it simulates";
  view.show(status);
  const QList<QLabel*> labels = view.findChildren<QLabel*>();
  EXPECT_TRUE(std::any_of(labels.begin(), labels.end(), [](const QLabel* label) {
    return label->text().startsWith("con") && label->text().endsWith("ates") &&
           label->toolTip().contains("takes the most of a step");
  }));
}

TEST(PipelineTree, PutsPartsBelowTheirStage) {
  PipelineTree tree;
  std::vector<rigid_body_sim::StageStatus> pipeline(3);
  pipeline[0].name = "forces.gravity";
  pipeline[0].reason = "off";
  pipeline[1].name = "islands.advance";
  pipeline[1].active = true;
  pipeline[1].seconds = 0.002;
  pipeline[2].name = "contacts.solve";
  pipeline[2].part_of = "islands.advance";
  tree.show(pipeline);
  ASSERT_EQ(tree.topLevelItemCount(), 2);
  ASSERT_EQ(tree.topLevelItem(1)->childCount(), 1);
  EXPECT_EQ(tree.topLevelItem(1)->child(0)->text(0), "contacts.solve");
  EXPECT_EQ(tree.topLevelItem(1)->text(1), "2.000");
  EXPECT_EQ(tree.topLevelItem(0)->text(1), "off");
  for (const int column : {0, 1, 2})
    EXPECT_EQ(tree.topLevelItem(0)->toolTip(column), "off") << "the column is narrow";
}

TEST(StepView, ExplainsTheStageThatIsClickedOrElseTheCostliest) {
  StepView view;
  view.resize(360, 300);
  view.setVisible(true);
  std::vector<rigid_body_sim::StageStatus> pipeline(3);
  pipeline[0].name = "forces.drag";
  pipeline[0].reason = "the scene has no air and no fluid";
  pipeline[1].name = "islands.advance";
  pipeline[1].active = true;
  pipeline[1].seconds = 0.003;
  pipeline[2].name = "contacts.solve";
  pipeline[2].part_of = "islands.advance";
  pipeline[2].active = true;
  pipeline[2].seconds = 0.0015;
  pipeline[2].items = 90;
  pipeline[2].unit = "points";
  pipeline[2].reason = "of the soft step, which is for the many groups that move";
  view.show(pipeline);
  const auto* const text = view.findChild<ElidedText*>();
  auto* const tree = view.findChild<PipelineTree*>();
  ASSERT_TRUE(text && tree);
  EXPECT_EQ(text->text(),
            "contacts.solve, 50 % of the step: 90 points: of the soft step, which is for the many groups "
            "that move");
  QTest::mouseClick(tree->viewport(), Qt::LeftButton, {},
                    tree->visualItemRect(tree->topLevelItem(0)).center());
  EXPECT_EQ(text->text(), "forces.drag, off: the scene has no air and no fluid");
  pipeline[2].seconds = 0.002;
  view.show(pipeline);
  EXPECT_EQ(text->text(), "forces.drag, off: the scene has no air and no fluid") << "it stays selected";
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "simulation_panel_test", ros::init_options::NoSigintHandler);
  QApplication application(argc, argv);
  const ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
