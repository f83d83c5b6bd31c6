// SPDX-License-Identifier: BSD-3-Clause
// The bodies panel, by its keys and its mouse, beside a running simulator; without a screen.
#include "wait_for.h"

#include "bodies_panel.h"
#include "simulator_bodies.h"

#include <rigid_body_sim/EditBodies.h>
#include <rigid_body_sim/GetBody.h>
#include <rigid_body_sim/ListBodies.h>
#include <rigid_body_sim/LoadScene.h>
#include <rigid_body_sim/NamedBodies.h>
#include <rigid_body_sim/SpawnBodies.h>
#include <rigid_body_sim/SpawnBody.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <std_srvs/Trigger.h>
#include <xmlrpcpp/XmlRpc.h>

#include <QApplication>
#include <QColorDialog>
#include <QDialog>
#include <QDoubleSpinBox>
#include <QInputDialog>
#include <QPointer>
#include <QPushButton>
#include <QTest>

#include <gtest/gtest.h>

#include <signal.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>

using namespace rbs;
using rbs::test::waitFor;

namespace {

template <class Service>
typename Service::Response call(const char* service, const typename Service::Request& request = {}) {
  static std::map<std::string, ros::ServiceClient> clients;
  ros::ServiceClient& client = clients[service];
  if (!client) {
    ros::service::waitForService("/sim/" + std::string(service),
                                 rbs::test::kPatience);  // the node may yet begin
    client = ros::NodeHandle().serviceClient<Service>("/sim/" + std::string(service), true);
  }
  typename Service::Response response;
  EXPECT_TRUE(client.call(request, response)) << service;
  EXPECT_TRUE(response.success) << service << ": " << response.message;
  return response;
}

rigid_body_sim::BodyState body(const std::string& name) {
  rigid_body_sim::GetBody::Request request;
  request.name = name;
  return call<rigid_body_sim::GetBody>("get_body", request).body;
}

std::vector<std::string> names() {
  return call<rigid_body_sim::ListBodies>("list_bodies").names;
}

void run() {
  ros::spinOnce();
  QTest::qWait(5);
}

// Whether it stays so for a while.
bool stays(const std::function<bool()>& condition) {
  for (int k = 0; k < 50; ++k) {
    if (!condition()) return false;
    run();
  }
  return true;
}

class BodiesPanelTest : public testing::Test {
 protected:
  void SetUp() override {
    rigid_body_sim::LoadScene::Request scene;
    scene.name = ros::package::getPath("rigid_body_sim") + "/test/node/small.yaml";
    call<rigid_body_sim::LoadScene>("load_scene", scene);
    panel_.load(config("/sim"));
    panel_.resize(400, 900);
    panel_.show();
    QApplication::setActiveWindow(&panel_);
    ASSERT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "crate", "ball"}); }));
    select({});
  }

  static rviz::Config config(const QString& node) {
    rviz::Config config;
    config.mapSetValue("Node", node);
    return config;
  }

  QTableView& list() { return *panel_.findChild<QTableView*>(); }
  QLineEdit& search() { return *panel_.findChild<QLineEdit*>("search"); }
  ValueField& field(const QString& name) {
    for (ValueField* const field : panel_.findChildren<ValueField*>())
      if (field->accessibleName() == name) return *field;
    throw std::runtime_error("no field " + name.toStdString());
  }
  bool isStruckOut(int row) {
    return list().model()->index(row, BodyTable::Name).data(Qt::FontRole).value<QFont>().strikeOut();
  }
  QString count() { return panel_.findChild<QLabel*>("count")->text(); }
  QString note() {
    for (const QLabel* const label : panel_.findChildren<QLabel*>("note"))
      if (label->isVisible()) return label->text();
    return {};
  }
  QStringList rows() {
    QStringList names;
    for (int row = 0; row < list().model()->rowCount(); ++row)
      names.append(list().model()->index(row, 0).data().toString());
    return names;
  }
  QStringList selectedRows() {
    QStringList names;
    for (const QModelIndex& index : list().selectionModel()->selectedRows())
      names.append(index.data().toString());
    names.sort();
    return names;
  }
  void click(const QString& name, Qt::KeyboardModifiers keys = Qt::NoModifier) {
    const int row = rows().indexOf(name);
    ASSERT_GE(row, 0) << name.toStdString();
    const QRect place = list().visualRect(list().model()->index(row, 1));
    QTest::mouseClick(list().viewport(), Qt::LeftButton, keys, place.center());
  }
  // The crate, by somebody else.
  void deleteWhileItsMassIsTyped(const char* text) {
    select({"crate"});
    ASSERT_TRUE(shows("Mass", "125"));
    ValueField& line = field("Mass");
    line.setFocus();
    line.selectAll();
    QTest::keyClicks(&line, text);
    rigid_body_sim::NamedBodies::Request request;
    request.names = {"crate"};
    call<rigid_body_sim::NamedBodies>("delete_bodies", request);
    ASSERT_TRUE(waitFor([&] { return !line.isVisible(); }));
  }
  void select(const QStringList& names) {
    rigid_body_sim::BodyNames message;
    for (const QString& name : names) message.names.push_back(name.toStdString());
    ASSERT_TRUE(waitFor([] { return select_.getNumSubscribers() > 0; }));
    select_.publish(message);
    QStringList sorted = names;
    sorted.sort();
    ASSERT_TRUE(waitFor([&] { return selectedRows() == sorted; }));
  }
  /// Replaces what stands in a field, by keys.
  void enter(const QString& name, const QString& text) {
    ValueField& line = field(name);
    line.setFocus();
    line.selectAll();
    QTest::keyClicks(&line, text);
    QTest::keyClick(&line, Qt::Key_Return);
  }
  void makeGroup(const QString& name) {
    list().setFocus();
    QTest::keyClick(&list(), Qt::Key_G, Qt::ControlModifier);
    auto* const dialog = panel_.findChild<QInputDialog*>();
    ASSERT_TRUE(dialog);
    dialog->setTextValue(name);
    dialog->accept();
  }
  /// Types a new name into a row of the list; returns the editor, null where none has opened.
  QLineEdit* typeName(int row, const QString& name) {
    list().setFocus();
    list().setCurrentIndex(list().model()->index(row, 0));
    QTest::keyClick(&list(), Qt::Key_F2);
    auto* const editor = list().viewport()->findChild<QLineEdit*>();
    if (editor) QTest::keyClicks(editor, name);
    return editor;
  }
  bool shows(const QString& name, const QString& text) {
    return waitFor([&] { return field(name).text() == text; });
  }

  BodiesPanel panel_;
  static ros::Publisher select_;

 public:
  static void connect(ros::NodeHandle& node) {
    select_ = node.advertise<rigid_body_sim::BodyNames>("/sim/select_bodies", 10);
  }
};

ros::Publisher BodiesPanelTest::select_;

TEST_F(BodiesPanelTest, SelectsInStepWithTheSimulator) {
  click("crate");
  std::vector<std::string> selected;
  ros::NodeHandle node;
  const boost::function<void(const rigid_body_sim::BodyNames&)> keep =
      [&](const rigid_body_sim::BodyNames& message) { selected = message.names; };
  const ros::Subscriber subscriber =
      node.subscribe<rigid_body_sim::BodyNames>("/sim/selected_bodies", 1, keep);
  EXPECT_TRUE(waitFor([&] { return selected == std::vector<std::string>{"crate"}; }));
  click("ball", Qt::ControlModifier);
  EXPECT_TRUE(waitFor([&] { return selected == std::vector<std::string>({"crate", "ball"}); }));
  click("crate", Qt::ControlModifier);
  EXPECT_TRUE(waitFor([&] { return selected == std::vector<std::string>{"ball"}; }));
  select({"floor", "crate"});
  select({});
}

TEST_F(BodiesPanelTest, FindsBodiesByEveryWord) {
  QTest::keyClicks(&search(), "sph dyn");
  EXPECT_TRUE(waitFor([&] { return rows() == QStringList{"ball"}; }));
  search().clear();
  QTest::keyClicks(&search(), "STATIC");
  EXPECT_TRUE(waitFor([&] { return rows() == QStringList{"floor"}; }));
  select({"floor"});
  search().setText("no such body");
  EXPECT_TRUE(waitFor([&] { return rows().isEmpty(); }));
  EXPECT_TRUE(
      stays([this] { return count().contains("1 selected"); }));  // what the filter hides stays selected
  search().clear();
  EXPECT_TRUE(waitFor([&] { return selectedRows() == QStringList{"floor"}; }));
}

// Else Delete would take along what nobody sees.
TEST_F(BodiesPanelTest, AClickSelectsNoBodyThatIsNotListed) {
  select({"floor"});
  search().setText("crate");
  ASSERT_TRUE(waitFor([&] { return rows() == QStringList{"crate"}; }));
  click("crate", Qt::ControlModifier);
  EXPECT_TRUE(waitFor([this] { return count().contains("2 selected"); })) << count().toStdString();
  click("crate");
  EXPECT_TRUE(waitFor([this] { return count().contains("1 selected"); })) << count().toStdString();
  search().clear();
  EXPECT_TRUE(waitFor([&] { return selectedRows() == QStringList{"crate"}; }));
}

TEST_F(BodiesPanelTest, DeleteTakesNoBodyThatTheSearchHides) {
  select({"crate", "ball"});
  search().setFocus();
  QTest::keyClicks(&search(), "ball");
  ASSERT_TRUE(waitFor([&] { return rows() == QStringList{"ball"}; }));
  EXPECT_TRUE(count().contains("2 selected, 1 of them not listed")) << count().toStdString();
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_Delete);
  EXPECT_TRUE(waitFor([] { return names() == std::vector<std::string>({"floor", "crate"}); }));
  ASSERT_TRUE(waitFor([&] { return rows().isEmpty(); }));
  QTest::keyClick(&list(), Qt::Key_Delete);
  EXPECT_TRUE(stays([] { return names() == std::vector<std::string>({"floor", "crate"}); }));
}

TEST_F(BodiesPanelTest, PropertiesAreOfNoBodyThatTheSearchHides) {
  select({"crate", "ball"});
  ASSERT_TRUE(waitFor([this] { return field("Mass").placeholderText() == "mixed"; }));
  search().setText("ball");
  ASSERT_TRUE(shows("Name", "ball"));
  enter("Mass", "3");
  EXPECT_TRUE(waitFor([] { return body("ball").description.mass == 3.0; }));
  EXPECT_EQ(body("crate").description.mass, 125.0);
  search().setText("floor");
  EXPECT_TRUE(waitFor([this] { return !field("Mass").isVisible(); }));
  const QList<QLabel*> labels = panel_.findChildren<QLabel*>();
  EXPECT_TRUE(std::any_of(labels.begin(), labels.end(), [](const QLabel* label) {
    return label->isVisible() && label->text().startsWith("The selected bodies are not listed");
  }));
  search().clear();
  EXPECT_TRUE(waitFor([this] { return field("Mass").isVisible() && field("Mass").text().isEmpty(); }));
}

TEST_F(BodiesPanelTest, ChangesEveryNumberOfABody) {
  select({"crate"});
  ASSERT_TRUE(shows("Position z", "0.25"));
  const std::vector<std::pair<QString, std::function<double()>>> fields = {
      {"Position x", [] { return body("crate").pose.position.x; }},
      {"Velocity z", [] { return body("crate").twist.linear.z; }},
      {"Spin y", [] { return body("crate").twist.angular.y; }},
      {"Size y", [] { return body("crate").description.size.y; }},
      {"Mass", [] { return body("crate").description.mass; }},
      {"Density", [] { return body("crate").description.density; }},
      {"Friction", [] { return body("crate").description.material.friction[0]; }},
      {"Restitution", [] { return body("crate").description.material.restitution[0]; }},
      {"Rolling", [] { return body("crate").description.material.rolling_resistance[0]; }},
      {"Torsion", [] { return body("crate").description.material.torsional_resistance[0]; }},
      {"Drag", [] { return body("crate").description.material.drag_coefficient[0]; }}};
  double value = 0.125;
  for (const auto& [name, read] : fields) {
    enter(name, QString::number(value));
    EXPECT_TRUE(waitFor([&] { return read() == value; }))
        << name.toStdString() << ": " << note().toStdString();
    EXPECT_EQ(note(), "");
    value += 0.0625;
  }
  enter("Rotation z", "90");
  EXPECT_TRUE(waitFor([] { return std::abs(body("crate").pose.orientation.z - std::sqrt(0.5)) < 1e-12; }));
  enter("Group", "0xff");
  EXPECT_TRUE(waitFor([] { return body("crate").description.collision_group == 255; }));
  enter("Mask", "6");
  EXPECT_TRUE(waitFor([] { return body("crate").description.collision_mask == 6; }));
  EXPECT_TRUE(shows("Mask", "0x6"));
  enter("Name", "chest");
  EXPECT_TRUE(waitFor([this] { return rows().contains("chest"); }));
  EXPECT_TRUE(waitFor([this] { return selectedRows() == QStringList{"chest"}; }));
}

TEST_F(BodiesPanelTest, ShowsWhatBodiesHaveInCommonAndSetsAllOfThemInOneEdit) {
  select({"crate", "ball"});
  ASSERT_TRUE(shows("Position y", "0"));
  EXPECT_EQ(field("Position x").text(), "");
  EXPECT_EQ(field("Position x").placeholderText(), "mixed");
  EXPECT_EQ(field("Size x").placeholderText(), "mixed");
  enter("Position z", "4");
  EXPECT_TRUE(
      waitFor([] { return body("crate").pose.position.z == 4.0 && body("ball").pose.position.z == 4.0; }));
  EXPECT_EQ(body("ball").pose.position.x, 2.0);
  enter("Size x", "0.3");  // of the ball as well: its diameter
  EXPECT_TRUE(waitFor([] { return body("ball").description.size.z == 0.3; }));
  EXPECT_EQ(body("crate").description.size.y, 0.5);
  enter("Name", "thing");
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "thing_1", "thing_2"}); }));
  call<std_srvs::Trigger>("undo");
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "crate", "ball"}); }));
}

TEST_F(BodiesPanelTest, SaysBesideTheFieldWhyItWasRefused) {
  select({"crate", "ball"});
  ASSERT_TRUE(shows("Position y", "0"));
  const std::string before = call<rigid_body_sim::ListBodies>("list_bodies").hash;
  struct Bad {
    const char *field, *text, *word;
  };
  for (const Bad& bad :
       {Bad{"Friction", "-1", "-1"}, Bad{"Friction", "abc", "a number"}, Bad{"Friction", "nan", "a number"},
        Bad{"Friction", "1e400", "a number"}, Bad{"Restitution", "2", "0 to 1"}, Bad{"Mass", "0", "above 0"},
        Bad{"Mass", "-3", "-3"}, Bad{"Mass", "1,000", "1000 or 1.5"}, Bad{"Mask", "-1", "whole number"},
        Bad{"Mask", "0x1ffffffff", "whole number"}, Bad{"Position x", "1e300", "1e+300"},
        Bad{"Name", "a//b", "a//b"}, Bad{"Size y", "-1", "-1"}}) {
    SCOPED_TRACE(std::string(bad.field) + " " + bad.text);
    enter(bad.field, bad.text);
    ASSERT_TRUE(waitFor([&] { return note().contains(bad.word); })) << note().toStdString();
    EXPECT_EQ(field(bad.field).text(), bad.text);  // it stays, to be mended
    QTest::keyClick(&field(bad.field), Qt::Key_Escape);
    EXPECT_EQ(note(), "");
  }
  EXPECT_EQ(call<rigid_body_sim::ListBodies>("list_bodies").hash, before);
  field("Name").setText(QString(100000, 'a'));
  field("Name").setModified(true);
  QTest::keyClick(&field("Name"), Qt::Key_Return);
  ASSERT_TRUE(waitFor([&] { return !note().isEmpty(); }));
  EXPECT_LT(note().size(), 2000);
  enter("Friction", "");  // nothing typed changes nothing
  EXPECT_TRUE(shows("Friction", "0.6"));
}

// Mask is the last field of a panel that is too low for all of them.
TEST_F(BodiesPanelTest, ShowsARefusalWholeAndShort) {
  panel_.resize(400, 420);
  select({"crate"});
  ASSERT_TRUE(shows("Mass", "125"));
  enter("Mask", QString(6000, 'z'));
  ASSERT_TRUE(waitFor([this] { return note().contains("whole number"); })) << note().toStdString();
  EXPECT_LT(note().size(), 120);
  const auto isWhole = [this] {
    for (const QLabel* const label : panel_.findChildren<QLabel*>("note"))
      if (label->isVisible()) return label->visibleRegion().boundingRect().height() >= label->height();
    return false;
  };
  EXPECT_TRUE(waitFor(isWhole));
}

TEST_F(BodiesPanelTest, KeepsWhatIsTypedWhileTheSceneChanges) {
  select({"crate"});
  ASSERT_TRUE(shows("Position x", "0"));
  ValueField& line = field("Position x");
  line.setFocus();
  line.selectAll();
  QTest::keyClicks(&line, "1.5");
  rigid_body_sim::EditBodies::Request request;
  request.changes.resize(1);
  request.changes[0].name = "crate";
  request.changes[0].mass = 3.0;
  call<rigid_body_sim::EditBodies>("edit_bodies", request);
  EXPECT_TRUE(shows("Mass", "3"));
  EXPECT_EQ(line.text(), "1.5");
  QTest::keyClick(&line, Qt::Key_Return);
  EXPECT_TRUE(waitFor([] { return body("crate").pose.position.x == 1.5; }));
}

TEST_F(BodiesPanelTest, OutlivesABodyThatSomebodyElseDeletes) {
  select({"crate"});
  ValueField& line = field("Mass");
  ASSERT_TRUE(shows("Mass", "125"));
  line.setFocus();
  line.selectAll();
  QTest::keyClicks(&line, "7");
  rigid_body_sim::NamedBodies::Request request;
  request.names = {"crate"};
  call<rigid_body_sim::NamedBodies>("delete_bodies", request);
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "ball"}); }));
  EXPECT_TRUE(waitFor([&] { return !line.isVisible(); }));
  select({"ball"});
  EXPECT_TRUE(waitFor([&] { return line.text() != "7"; }));
  EXPECT_NE(body("ball").description.mass, 7.0);
}

TEST_F(BodiesPanelTest, DeletesDuplicatesAndRenamesByKeys) {
  select({"crate", "ball"});
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_D, Qt::ControlModifier);
  auto* const dialog = panel_.findChild<QDialog*>();
  ASSERT_TRUE(dialog);
  auto* const copies = dialog->findChild<QDoubleSpinBox*>();
  copies->selectAll();
  QTest::keyClicks(copies, "50000");
  dialog->accept();
  EXPECT_EQ(dialog->result(), QDialog::Rejected) << "the number that was typed is not taken";
  copies->setValue(2);
  dialog->accept();
  EXPECT_TRUE(waitFor([this] { return rows().size() == 7; }));
  EXPECT_TRUE(waitFor([this] { return selectedRows().size() == 4 && !selectedRows().contains("crate"); }));
  QApplication::setActiveWindow(&panel_);
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_Delete);
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "crate", "ball"}); }));
  QLineEdit* const editor = typeName(1, "chest");
  ASSERT_TRUE(editor);
  QTest::keyClick(editor, Qt::Key_Return);
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "chest", "ball"}); }));
}

// The press on the button ends the typing, and the box has its last number again.
TEST_F(BodiesPanelTest, NoNumberIsTakenInPlaceOfTheOneThatWasTyped) {
  select({"crate"});
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_D, Qt::ControlModifier);
  const QPointer<QDialog> dialog = panel_.findChild<QDialog*>();
  ASSERT_TRUE(dialog);
  QApplication::setActiveWindow(dialog);
  auto* const copies = dialog->findChild<QDoubleSpinBox*>();
  auto* const button = dialog->findChild<QPushButton*>();
  const auto refusal = [copies] {
    const auto* const label = copies->findChild<QLabel*>();
    return label->isVisible() ? label->text() : QString();
  };
  copies->setFocus();
  copies->selectAll();
  QTest::keyClicks(copies, "50000");
  QTest::mouseClick(button, Qt::LeftButton);
  EXPECT_FALSE(copies->hasFocus());
  ASSERT_TRUE(dialog && dialog->isVisible());
  EXPECT_TRUE(refusal().startsWith("50000")) << refusal().toStdString();
  EXPECT_EQ(copies->value(), 1.0);
  copies->setFocus();
  copies->selectAll();
  QTest::keyClicks(copies, "x");
  QTest::keyClick(copies, Qt::Key_Return);
  ASSERT_TRUE(dialog && dialog->isVisible());
  EXPECT_TRUE(refusal().startsWith("x")) << refusal().toStdString();
  copies->setValue(2);
  QTest::mouseClick(button, Qt::LeftButton);
  EXPECT_TRUE(waitFor([this] { return rows().size() == 5; }));
}

TEST_F(BodiesPanelTest, DuplicatesAllButThePlanes) {
  const auto duplicate = [this](const QStringList& names) {
    select(names);
    QApplication::setActiveWindow(&panel_);
    list().setFocus();
    QTest::keyClick(&list(), Qt::Key_D, Qt::ControlModifier);
    auto* const dialog = panel_.findChild<QDialog*>();
    ASSERT_TRUE(dialog);
    dialog->accept();
  };
  const auto says = [this](const char* words) {
    return waitFor([&] { return panel_.findChild<ElidedText*>()->text().contains(words); });
  };
  duplicate({"floor", "crate", "ball"});
  EXPECT_TRUE(says("added 2 copies, but none of 'floor'"));
  EXPECT_TRUE(waitFor([this] { return rows().size() == 5; }));
  duplicate({"floor"});
  EXPECT_TRUE(says("plane"));
  EXPECT_TRUE(stays([this] { return rows().size() == 5; }));
}

TEST_F(BodiesPanelTest, KeepsGroupsInTheLayout) {
  select({"ball"});
  makeGroup("round");
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList{"ball"}; }));
  rviz::Config layout;
  panel_.save(layout);
  BodiesPanel other;
  other.load(layout);
  other.show();
  EXPECT_GE(other.findChild<QComboBox*>("groups")->findText("round"), 0);
  QString node;
  EXPECT_TRUE(layout.mapGetString("Node", &node));
  EXPECT_EQ(node, "/sim");
}

// R records and 1 is the wind, but not while one looks for a name in the list; F looks at a body.
TEST_F(BodiesPanelTest, LettersLookForANameInTheList) {
  const auto takes = [this](int key, const QString& text, Qt::KeyboardModifiers with = Qt::NoModifier) {
    QKeyEvent press(QEvent::ShortcutOverride, key, with, text);
    press.ignore();
    QApplication::sendEvent(&list(), &press);
    return press.isAccepted();
  };
  EXPECT_TRUE(takes(Qt::Key_R, "r"));
  EXPECT_TRUE(takes(Qt::Key_1, "1"));
  EXPECT_FALSE(takes(Qt::Key_F, "f"));
  EXPECT_FALSE(takes(Qt::Key_H, "h"));
  EXPECT_FALSE(takes(Qt::Key_Space, " "));
  EXPECT_FALSE(takes(Qt::Key_Z, QString(QChar(26)), Qt::ControlModifier));
  select({});
  list().setFocus();
  QTest::keyClicks(&list(), "ba");
  EXPECT_TRUE(waitFor([this] { return selectedRows() == QStringList{"ball"}; }));
}

TEST_F(BodiesPanelTest, ANameThatIsTypedInTheListStaysWhileOthersEdit) {
  QLineEdit* const editor = typeName(1, "chest");
  ASSERT_TRUE(editor);
  rigid_body_sim::EditBodies::Request request;
  request.changes.resize(1);
  request.changes[0].name = "ball";
  request.changes[0].mass = 3.0;
  call<rigid_body_sim::EditBodies>("edit_bodies", request);
  ASSERT_TRUE(waitFor([this] { return list().model()->index(2, BodyTable::Mass).data().toString() == "3"; }));
  EXPECT_EQ(editor->text(), "chest");
  QTest::keyClick(editor, Qt::Key_Return);
  EXPECT_TRUE(waitFor([this] { return rows().contains("chest"); }));
}

TEST_F(BodiesPanelTest, ANameThatIsTypedInTheListStaysWhileBodiesComeAndGo) {
  select({"crate"});
  const QPointer<QLineEdit> editor = typeName(1, "chest");
  ASSERT_TRUE(editor);
  rigid_body_sim::SpawnBody::Request another;
  another.name = "another";
  call<rigid_body_sim::SpawnBody>("spawn_body", another);
  ASSERT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "crate", "ball", "another"}); }));
  rigid_body_sim::NamedBodies::Request floor;
  floor.names = {"floor"};
  call<rigid_body_sim::NamedBodies>("delete_bodies", floor);
  ASSERT_TRUE(waitFor([this] { return rows() == QStringList({"crate", "ball", "another"}); }));
  ASSERT_TRUE(editor);
  EXPECT_EQ(editor->text(), "chest");
  QTest::keyClick(editor, Qt::Key_Return);
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"chest", "ball", "another"}); }));
  EXPECT_TRUE(waitFor([this] { return selectedRows() == QStringList{"chest"}; }));
  call<std_srvs::Trigger>("undo");
  call<std_srvs::Trigger>("undo");
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList({"floor", "crate", "ball", "another"}); }));
}

// Half a number is for the body that it was begun for.
TEST_F(BodiesPanelTest, WhatIsTypedIsForTheBodyThatWasShown) {
  // Whatever the order of the selection: this is not that of the list.
  select({"ball", "crate"});
  ASSERT_TRUE(shows("Position y", "0"));
  ValueField& y = field("Position y");
  y.setFocus();
  y.selectAll();
  QTest::keyClicks(&y, "7");
  rigid_body_sim::EditBodies::Request nudge;
  nudge.changes.resize(1);
  nudge.changes[0].name = "floor";
  nudge.changes[0].material.friction = {0.3};
  call<rigid_body_sim::EditBodies>("edit_bodies", nudge);
  EXPECT_TRUE(stays([&] { return y.text() == "7"; }));
  QTest::keyClick(&y, Qt::Key_Escape);

  select({"crate"});
  ASSERT_TRUE(shows("Mass", "125"));
  const double before = body("ball").description.mass;
  ValueField& line = field("Mass");
  line.setFocus();
  line.selectAll();
  QTest::keyClicks(&line, "12");
  select({"ball"});
  QTest::keyClicks(&line, "34");
  QTest::keyClick(&line, Qt::Key_Return);
  EXPECT_TRUE(waitFor([] { return body("crate").description.mass == 1234.0; }));
  EXPECT_EQ(body("ball").description.mass, before);
  EXPECT_TRUE(waitFor([&] { return std::abs(line.text().toDouble() - before) < 1e-4 * before; }));
}

// And where that one is gone, it is for none.
TEST_F(BodiesPanelTest, WhatIsTypedForABodyThatIsGoneIsForNone) {
  deleteWhileItsMassIsTyped("12");
  ValueField& line = field("Mass");
  call<std_srvs::Trigger>("undo");
  select({"crate"});
  EXPECT_TRUE(shows("Mass", "125"));
  EXPECT_EQ(note(), "");

  // Another scene has a body of the same number.
  line.setFocus();
  line.selectAll();
  QTest::keyClicks(&line, "12");
  rigid_body_sim::LoadScene::Request other;
  other.name = "tower";
  call<rigid_body_sim::LoadScene>("load_scene", other);
  ASSERT_TRUE(waitFor([this] { return rows().contains("box_1"); }));
  const std::string hash = call<rigid_body_sim::ListBodies>("list_bodies").hash;
  EXPECT_TRUE(waitFor([&] { return !line.isVisible(); }));
  QTest::keyClicks(&line, "3");
  QTest::keyClick(&line, Qt::Key_Return);
  EXPECT_TRUE(stays([&] { return call<rigid_body_sim::ListBodies>("list_bodies").hash == hash; }));
}

// Qt would hand the focus to the next field, the one of the node.
TEST_F(BodiesPanelTest, TheFocusGoesToTheListWhenTheBodyOfAFieldIsGone) {
  deleteWhileItsMassIsTyped("8");
  EXPECT_TRUE(list().hasFocus());
  QWidget* const focus = QApplication::focusWidget();
  QTest::keyClicks(focus, ".5");
  QTest::keyClick(focus, Qt::Key_Return);
  EXPECT_EQ(panel_.findChild<NodeBox*>()->node(), "/sim");
  const QList<ElidedText*> texts = panel_.findChildren<ElidedText*>();
  EXPECT_TRUE(std::any_of(texts.begin(), texts.end(),
                          [](const ElidedText* text) { return text->text() == "'crate' is gone."; }));
  call<std_srvs::Trigger>("undo");
}

// The process of a node.
pid_t processOf(const std::string& node) {
  XmlRpc::XmlRpcValue question, answer, place, caller;
  question[0] = caller[0] = ros::this_node::getName();
  question[1] = node;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::master::execute("lookupNode", question, answer, place, true)) return -1;
  if (!ros::network::splitURI(place, host, port)) return -1;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  return client.execute("getPid", caller, answer) ? static_cast<int>(answer[2]) : -1;
}

// What is done meanwhile is not done later, all at once.
TEST_F(BodiesPanelTest, NothingIsDoneWhileTheSimulatorIsSilent) {
  select({"crate"});
  ASSERT_TRUE(shows("Mass", "125"));
  const std::string hash = call<rigid_body_sim::ListBodies>("list_bodies").hash;
  const auto says = [this] { return panel_.findChild<ElidedText*>()->text(); };
  const pid_t simulator = processOf("/sim");
  ASSERT_GT(simulator, 1);
  kill(simulator, SIGSTOP);
  EXPECT_TRUE(waitFor([&] { return says() == "No simulator answers at '/sim'."; }));
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_Delete);
  const QModelIndex crate = list().model()->index(1, BodyTable::Name);
  EXPECT_FALSE(field("Mass").isEnabled());
  EXPECT_FALSE(crate.flags() & Qt::ItemIsEditable);
  kill(simulator, SIGCONT);
  EXPECT_TRUE(waitFor([&] { return says().isEmpty(); }));
  EXPECT_TRUE(field("Mass").isEnabled());
  EXPECT_TRUE(crate.flags() & Qt::ItemIsEditable);
  EXPECT_TRUE(stays([&] { return call<rigid_body_sim::ListBodies>("list_bodies").hash == hash; }));
  enter("Mass", "7");
  EXPECT_TRUE(waitFor([] { return body("crate").description.mass == 7.0; }));
}

// A press on a wall asks what is behind it. The window goes on meanwhile.
TEST_F(BodiesPanelTest, WhatTheMouseAsksASilentSimulatorHoldsNothingUp) {
  SimulatorBodies bodies("/sim");
  const geometry_msgs::Point crate = body("crate").pose.position;
  geometry_msgs::Point above = crate;
  above.z += 20.0;
  geometry_msgs::Vector3 down;
  down.z = -1.0;
  // What is met, and how often the event loop went round before that.
  const auto meet = [&](int& turns) {
    std::optional<SimulatorBodies::Answer> answer;
    bodies.meet(above, down, [&](const auto& said) { answer = said; });
    EXPECT_FALSE(answer) << "it is given by the event loop";
    EXPECT_TRUE(waitFor([&] { return ++turns, answer.has_value(); }));
    return answer.value_or(SimulatorBodies::Answer());
  };
  int turns = 0;
  SimulatorBodies::Answer said;
  ASSERT_TRUE(waitFor([&] { return said = meet(turns), said.came; }))
      << "a busy machine may take longer than 0.2 s";
  ASSERT_TRUE(said.met);
  EXPECT_EQ(said.met->body.description.name, "crate");
  EXPECT_NEAR(said.met->point.x, crate.x, 1e-9);

  const pid_t simulator = processOf("/sim");
  ASSERT_GT(simulator, 1);
  kill(simulator, SIGSTOP);
  turns = 0;
  EXPECT_FALSE(meet(turns).came);
  EXPECT_GE(turns, 10);
  kill(simulator, SIGCONT);

  int calls = 0;
  {
    SimulatorBodies gone("/sim");
    gone.meet(above, down, [&](const auto&) { ++calls; });
  }
  EXPECT_TRUE(stays([&] { return calls == 0; })) << "who asked is gone";
}

// The field with the focus would enter it into a client that is gone.
TEST_F(BodiesPanelTest, WhatIsHalfTypedIsDroppedWithThePanel) {
  select({"crate"});
  ASSERT_TRUE(shows("Mass", "125"));
  {
    BodiesPanel other;
    other.load(config("/sim"));
    other.show();
    QApplication::setActiveWindow(&other);
    ASSERT_TRUE(waitFor([&] { return other.findChild<QTableView*>()->selectionModel()->hasSelection(); }));
    for (ValueField* const line : other.findChildren<ValueField*>()) {
      if (line->accessibleName() != "Mass") continue;
      line->setFocus();
      ASSERT_TRUE(waitFor([&] { return line->text() == "125"; }));
      QTest::keyClicks(line, "7");
    }
  }
  EXPECT_TRUE(stays([] { return body("crate").description.mass == 125.0; }));
}

TEST_F(BodiesPanelTest, UndoIsOfTheTextOnlyWhereOneIsTyped) {
  select({"crate"});
  ASSERT_TRUE(shows("Mass", "125"));
  const auto takes = [this](int key, Qt::KeyboardModifiers with) {
    QKeyEvent press(QEvent::ShortcutOverride, key, with);
    press.ignore();
    QApplication::sendEvent(&field("Mass"), &press);
    return press.isAccepted();
  };
  enter("Mass", "5");
  EXPECT_TRUE(waitFor([] { return body("crate").description.mass == 5.0; }));
  EXPECT_FALSE(takes(Qt::Key_Z, Qt::ControlModifier));
  EXPECT_FALSE(takes(Qt::Key_Z, Qt::ControlModifier | Qt::ShiftModifier));
  QTest::keyClicks(&field("Mass"), "7");
  EXPECT_TRUE(takes(Qt::Key_Z, Qt::ControlModifier));
}

TEST_F(BodiesPanelTest, AGroupFollowsARename) {
  select({"ball"});
  makeGroup("round");
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList{"ball"}; }));
  enter("Name", "globe");
  EXPECT_TRUE(
      waitFor([this] { return rows() == QStringList{"globe"} && selectedRows() == QStringList{"globe"}; }));
  for (const ElidedText* text : panel_.findChildren<ElidedText*>())
    EXPECT_FALSE(text->text().contains("is gone")) << text->text().toStdString();
}

TEST_F(BodiesPanelTest, HidesAndShowsByKeys) {
  select({"ball"});
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_H);
  EXPECT_TRUE(waitFor([this] { return isStruckOut(2) && !isStruckOut(1); }));
  QTest::keyClick(&list(), Qt::Key_H, Qt::ShiftModifier);
  EXPECT_TRUE(waitFor([this] { return !isStruckOut(2); }));
}

TEST_F(BodiesPanelTest, ColoursByTheDialogue) {
  select({"ball"});
  const QList<QToolButton*> buttons = panel_.findChildren<QToolButton*>();
  const auto button = std::find_if(buttons.begin(), buttons.end(),
                                   [](const QToolButton* other) { return other->toolTip() == "Colour"; });
  ASSERT_NE(button, buttons.end());
  ASSERT_TRUE(waitFor([&] { return (*button)->isVisible(); }));
  QTest::mouseClick(*button, Qt::LeftButton);
  auto* const dialog = panel_.findChild<QColorDialog*>();
  ASSERT_TRUE(dialog);
  const QList<QLineEdit*> edits = dialog->findChildren<QLineEdit*>();
  const auto name = std::find_if(edits.begin(), edits.end(),
                                 [](const QLineEdit* other) { return other->text().startsWith('#'); });
  ASSERT_NE(name, edits.end());
  (*name)->selectAll();
  QTest::keyClicks(*name, "#00ff80");
  QTest::keyClick(*name, Qt::Key_Return);
  EXPECT_TRUE(waitFor([] { return body("ball").description.color.g == 1.0f; }));
  EXPECT_EQ(body("ball").description.color.r, 0.0f);
}

// Of anyone: another client, an undo, and a reset.
TEST_F(BodiesPanelTest, AGroupAndWhatIsHiddenFollowRenamesOfOthers) {
  select({"ball"});
  makeGroup("round");
  ASSERT_TRUE(waitFor([this] { return rows() == QStringList{"ball"}; }));
  list().setFocus();
  QTest::keyClick(&list(), Qt::Key_H);
  const auto isListedAlone = [this](const QString& name) {
    return waitFor([&] { return rows() == QStringList{name} && isStruckOut(0); });
  };
  EXPECT_TRUE(isListedAlone("ball"));
  rigid_body_sim::EditBodies::Request request;
  request.changes.resize(1);
  request.changes[0].name = "ball";
  request.changes[0].new_name = "globe";
  call<rigid_body_sim::EditBodies>("edit_bodies", request);
  EXPECT_TRUE(isListedAlone("globe"));
  call<std_srvs::Trigger>("undo");
  EXPECT_TRUE(isListedAlone("ball"));
  call<std_srvs::Trigger>("redo");
  EXPECT_TRUE(isListedAlone("globe"));
  call<std_srvs::Trigger>("reset");
  EXPECT_TRUE(isListedAlone("ball"));
}

// In another scene a handle is another body's.
TEST_F(BodiesPanelTest, AGroupStaysWithItsNamesInAnotherScene) {
  select({"ball"});
  makeGroup("round");
  ASSERT_TRUE(waitFor([this] { return rows() == QStringList{"ball"}; }));
  rigid_body_sim::LoadScene::Request scene;
  scene.name = "tower";
  call<rigid_body_sim::LoadScene>("load_scene", scene);
  EXPECT_TRUE(waitFor([this] { return rows().isEmpty(); }));
  scene.name = ros::package::getPath("rigid_body_sim") + "/test/node/small.yaml";
  call<rigid_body_sim::LoadScene>("load_scene", scene);
  EXPECT_TRUE(waitFor([this] { return rows() == QStringList{"ball"}; }));
}

TEST_F(BodiesPanelTest, TheWheelChangesNothing) {
  select({"crate"});
  for (QComboBox* const box : panel_.findChildren<QComboBox*>()) {
    QWheelEvent wheel(QPointF(5, 5), QPointF(5, 5), QPoint(), QPoint(0, -120), Qt::NoButton, Qt::NoModifier,
                      Qt::NoScrollPhase, false);
    QApplication::sendEvent(box, &wheel);
  }
  EXPECT_TRUE(stays([] { return body("crate").description.kind == "dynamic"; }));
}

TEST_F(BodiesPanelTest, TellsOfANameThatIsNone) {
  panel_.load(config("no name"));
  EXPECT_TRUE(waitFor([this] { return rows().isEmpty(); }));
  EXPECT_FALSE(panel_.findChild<ElidedText*>()->text().isEmpty());
  panel_.load(config("/nobody"));
  EXPECT_TRUE(stays([this] { return rows().isEmpty(); }));
  panel_.load(config("/sim"));
  EXPECT_TRUE(waitFor([this] { return rows().size() == 3; }));
}

TEST_F(BodiesPanelTest, ThousandsOfBodiesAreSelectedAndChanged) {
  rigid_body_sim::SpawnBodies::Request request;
  for (int k = 0; k < 5000; ++k) {
    rigid_body_sim::BodySpec spec;
    spec.shape = "sphere";
    spec.size.x = 0.1;
    spec.pose.position.x = 0.2 * (k % 70);
    spec.pose.position.y = 0.2 * (k / 70);
    spec.pose.position.z = 9.0;
    request.bodies.push_back(spec);
  }
  call<rigid_body_sim::SpawnBodies>("spawn_bodies", request);
  ASSERT_TRUE(waitFor([this] { return rows().size() == 5003; }));
  list().selectAll();
  ASSERT_TRUE(
      waitFor([this] { return field("Position x").isVisible() && field("Density").text() == "1000"; }));
  enter("Density", "500");
  EXPECT_TRUE(waitFor([] { return body("ball").description.density == 500.0; }));
  EXPECT_EQ(note(), "");
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bodies_panel_test", ros::init_options::NoSigintHandler);
  QApplication application(argc, argv);
  ros::NodeHandle node;
  BodiesPanelTest::connect(node);
  return RUN_ALL_TESTS();
}
