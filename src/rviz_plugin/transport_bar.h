// SPDX-License-Identifier: BSD-3-Clause
// The buttons that run, step, reset, pace and record the simulation, and undo edits; of a replay, the time in it.
#pragma once

#include "bag_recorder.h"
#include "elided_text.h"
#include "number_box.h"
#include "seek_bar.h"
#include "simulator_client.h"

#include <QHBoxLayout>
#include <QSlider>
#include <QToolButton>
#include <QWidget>

namespace rbs {

class TransportBar : public QWidget {
  Q_OBJECT
 public:
  explicit TransportBar(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);
  /// What the keys do: run or pause; take the number of steps that is shown, while paused; double or halve the
  /// requested speed.
  void playOrPause();
  void step();
  void goFaster() { scaleSpeed(2.0); }
  void goSlower() { scaleSpeed(0.5); }
  /// Without a simulator nothing but a recording can be ended.
  void setHeard(bool is_heard);
  /// Begins to record, or ends it.
  void record();

  bool isRecording() const { return recorder_.state() != BagRecorder::State::Idle; }
  /// Folder of the recordings.
  const QString& folder() const { return folder_; }
  /// What is said of the recording, for a place where it moves no control.
  QWidget* recordingNote() const { return note_; }
  void setFolder(const QString& folder) { folder_ = folder; }  ///< of those begun from now on

 Q_SIGNALS:
  void recordingChanged();  ///< a recording has begun, or is over
  void folderChanged();     ///< the user has chosen another folder

 private:
  void scaleSpeed(double factor);
  void showSpeed(double factor);
  void askToReset();
  void askFolder();
  void showRecording();
  void note(const QString& text, bool is_trouble);
  QToolButton* addButton(const QIcon& icon, const QString& tip);

  SimulatorClient& simulator_;
  QHBoxLayout* row_;  ///< of the buttons
  QToolButton* play_;
  QToolButton* step_;
  NumberBox* steps_;
  QSlider* slider_;  ///< logarithm of the requested speed
  NumberBox* speed_;
  QToolButton *undo_, *redo_;
  QToolButton* reset_;
  QToolButton* record_;
  BagRecorder recorder_;
  QString folder_;
  ElidedText* note_;  ///< of the recording
  SeekBar* seek_bar_;
  bool is_paused_ = true;
  bool is_unsaved_ = false;
  bool is_replay_ = false;
};

}  // namespace rbs
