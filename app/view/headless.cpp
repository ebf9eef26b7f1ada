// SPDX-License-Identifier: Apache-2.0
#include "app/view/headless.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <utility>

#include "app/output/tables.hpp"
#include "app/output/vtu.hpp"
#include "sunder/error.hpp"

namespace sunder::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFilm = 6;  // pictures on the strip

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Adds what passes while it lives.
class Timed {
 public:
  explicit Timed(HeadlessOutcome::Stage& stage) : stage_(stage) {}
  ~Timed() {
    stage_.seconds += std::chrono::duration<double>(Clock::now() - start_).count();
    stage_.processor_seconds += processor_seconds() - processor_;
  }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  HeadlessOutcome::Stage& stage_;
  const Clock::time_point start_ = Clock::now();
  const double processor_ = processor_seconds();
};

std::string picture_name(int frame) {
  const std::string digits = std::to_string(frame);
  return "frame_" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits + ".png";
}

class Playing {
 public:
  Playing(Session& session, Painter& painter, ResultFolder& folder, const HeadlessPlan& plan)
      : session_(session),
        painter_(&painter),
        size_(painter.renderer().size()),
        folder_(folder),
        plan_(plan) {}

  HeadlessOutcome play() {
    try {
      if (plan_.inputs) play_inputs();
      while (frame_ < plan_.frames) take_frame();
    } catch (const NumericalError& error) {
      outcome_.failure = error.what();
    } catch (const DeviceError& error) {
      if (!lost_) throw;
      outcome_.lost = error.what();
      record();
      return std::move(outcome_);
    }
    finish();
    return std::move(outcome_);
  }

 private:
  void play_inputs() {
    for (const Input& input : plan_.inputs->list) {
      const auto* frames = std::get_if<input::Frame>(&input.what);
      if (frame_ == plan_.frames) {
        outcome_.inputs_left = true;
        return;
      }
      if (!frames) session_.take(*plan_.inputs, input);
      for (int i = 0; frames && i < frames->count && frame_ < plan_.frames; ++i) take_frame();
    }
  }

  void take_frame() {
    {
      const Timed timed(outcome_.stepping);
      session_.advance();
    }
    ++frame_;
    if (session_.look().pictures) take_picture();
    if (plan_.progress) plan_.progress(frame_);
  }

  void take_picture() {
    ++outcome_.pictures;
    show_or_go_on();
    const Timed timed(outcome_.writing);
    write(picture_name(frame_), keep(painter_->png()));
  }

  void show() {
    std::shared_ptr<const Shown> shown;
    {
      const Timed timed(outcome_.showing);
      shown = session_.show(painter_->version());
    }
    const Timed timed(outcome_.drawing);
    painter_->draw(std::move(shown), session_.look(), session_.camera());
  }

  /// Once more on another device where the first is lost under it.
  void show_or_go_on() {
    try {
      show();
    } catch (const DeviceLost& error) {
      if (!plan_.renew) throw;
      lost_ = true;
      painter_ = nullptr;
      painter_ = &plan_.renew(error.what());
      show();
      lost_ = false;
    }
  }

  /// The last picture of each sixth of the frames goes on the strip as well.
  const std::string& keep(std::string png) {
    const auto sixth = [&](int frame) {
      return std::min<long long>(kFilm, plan_.frames) * frame / plan_.frames;
    };
    last_ = std::move(png);
    if (sixth(frame_) > sixth(frame_ - 1)) {
      film_.push_back({last_, "frame " + std::to_string(frame_)});
    }
    return last_;
  }

  void write(const std::string& name, std::string_view bytes) {
    folder_.write(name, bytes);
    outcome_.files.push_back(name);
  }

  /// The recording comes last: where it is, all is there.
  void finish() {
    if (!film_.empty()) {
      write("film.png", film_of(session_.problem().scene().title, film_, size_));
    }
    std::string events = events_header();
    for (const DestroyedElement& row : session_.simulation().destroyed()) events += events_row(row);
    write("events.csv", events);
    ResultFile result(folder_, "result.vtu");
    write_vtu(result, session_.problem(), state_of(session_.simulation()));
    result.commit();
    outcome_.files.push_back("result.vtu");
    record();
  }

  void record() {
    if (plan_.inputs) write("recording.inputs", session_.hand().recording());
    write("recording.toml", plan_.recording(session_.origin()));
  }

  Session& session_;
  Painter* painter_;  // null: it went with its device
  const PictureSize size_;
  ResultFolder& folder_;
  const HeadlessPlan& plan_;
  HeadlessOutcome outcome_;
  int frame_ = 0;
  bool lost_ = false;  // the device, and there is no other yet
  std::string last_;
  std::vector<FilmFrame> film_;
};

}  // namespace

HeadlessOutcome play(Session& session, Painter& painter, ResultFolder& folder,
                     const HeadlessPlan& plan) {
  return Playing(session, painter, folder, plan).play();
}

}  // namespace sunder::app
