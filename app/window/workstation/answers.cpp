// What panels and questions ask for.
#include "app/window/workstation/workstation.h"

#include <utility>

#include "app/window/result_files.h"

namespace fettle::app {

void Workstation::carryOut(PanelRequests requests) {
  if (requests.open) askToOpen(*requests.open);
  if (requests.sample) parts_.files.makeSample();
  if (requests.loop.rate_hz) setRate(*requests.loop.rate_hz);
  if (requests.loop.device) setDevice(*requests.loop.device);
  if (requests.loop.fit_scene) fitScene();
  if (requests.answer) carryOut(*std::move(requests.answer));
}

void Workstation::carryOut(Answer answer) {
  using Kind = Question::Kind;
  using Choice = Answer::Choice;
  Parts& p = parts_;
  Question& question = answer.question;
  const bool confirmed = answer.choice == Choice::kConfirm;
  if (answer.choice == Choice::kBack) {
    // Back to the dialog in which the path was typed.
    if (question.kind == Kind::kImport) unconfirmed_.reset();
    if (question.typed)
      p.feedback.questions.ask({.kind = question.from,
                                .path = std::move(question.path),
                                .afterwards = std::move(question.afterwards)});
    return;
  }
  switch (question.kind) {
    case Kind::kOpen:
      dialog_path_ = question.path;
      if (confirmed)
        askToOpen(question.path);
      else
        p.feedback.questions.ask({.kind = Kind::kImport,
                                  .path = question.path,
                                  .reading = parts_.readingOf(question.path),
                                  .from = Kind::kOpen,
                                  .typed = true});
      break;
    case Kind::kImport:
      p.files.readings.note(question.path, *question.reading);
      if (question.guessed == nullptr)
        askToOpen(question.path, std::move(question.reading));
      else if (auto read = std::exchange(unconfirmed_, std::nullopt);
               read && scanOptionsText(*question.reading).empty())
        startDocument(*std::move(read));
      else
        load(question.path, Recovery::kLeave, question.reading);  // it was said where its work goes
      break;
    case Kind::kCompare:
      p.compare.compareWith(*p.document.client(), question.path, options_.reading);
      p.settings.panels["Compare"] = true;
      p.enter_panel = "Compare";
      break;
    case Kind::kJoin:
      p.join.add({question.path, p.readingOf(question.path)});
      p.settings.panels["Join"] = true;
      p.enter_panel = "Join";
      break;
    case Kind::kSaveAs:
    case Kind::kExport:
      p.saving.askToWrite(std::move(question), Saving::Typed::kYes, p.document, p.feedback);
      break;
    case Kind::kExportSections:
    case Kind::kExportReport:
    case Kind::kExportFits:
    case Kind::kExportFeatures:
      confirmResult(std::move(question), p);
      break;
    case Kind::kUnsaved:
      if (question.stop_asking) p.settings.ask_before_quitting = false;
      if (confirmed)
        p.saving.save(p.document, p.feedback, std::move(question.afterwards));
      else
        resumeAfterSave(question.afterwards);
      break;
    case Kind::kOpenScene:
    case Kind::kSaveScene:
    case Kind::kUnsavedScene:
      carryOutOfScene(std::move(answer));
      break;
    case Kind::kReplace:
      if (question.from == Kind::kSaveScene) return carryOutOfScene(std::move(answer));
      if (resultFileOf(question.from) != nullptr)
        writeResult(question.from, question.path, p);
      else
        p.saving.start(question.path, Saving::keepingOf(question.from), std::move(question.afterwards),
                       p.document, p.feedback);
      break;
    case Kind::kRecover:
      load(question.path, confirmed ? Recovery::kTake : Recovery::kLeave, question.reading);
      break;
    case Kind::kDevice:
      if (confirmed) setUpDevice(p.device_setup);
      break;
    case Kind::kShortcuts:
      if (question.wanted) app::carryOut(*question.wanted, p);
      if (question.filter) p.filters.chooseKind(*question.filter, p.document.client()->field().grid());
      if (!question.panel.empty()) {
        p.settings.side_panel = p.settings.panels[question.panel] = true;
        p.enter_panel = question.panel;
      }
      break;
    case Kind::kMessage:
      break;
  }
}

void Workstation::carryOutOfScene(Answer answer) {
  using Kind = Question::Kind;
  Parts& p = parts_;
  Question& question = answer.question;
  LoopClient& client = *p.document.client();
  bool felt = false;  // the file is what is felt
  switch (question.kind) {
    case Kind::kOpenScene:
      felt = p.scene_files.open(question.path, client, p.feedback);
      break;
    case Kind::kUnsavedScene:
      if (question.stop_asking) p.settings.ask_before_quitting = false;
      if (answer.choice == Answer::Choice::kConfirm) {
        p.feedback.questions.ask({.kind = Kind::kSaveScene,
                                  .path = p.scenePathToSave(),
                                  .afterwards = std::move(question.afterwards)});
        return;
      }
      p.scene_files.leave(client);
      app::carryOut(Action::kQuit, p);
      return;
    case Kind::kReplace:
      felt = p.scene_files.save(question.path, client, p.feedback);
      break;
    default:
      felt = p.scene_files.askToSave(question, client, p.feedback);
      break;
  }
  if (!felt) return;
  // Of the next scan as well.
  options_.scene = client.scene();
  options_.scene_path = p.scene_files.path();
  if (question.afterwards.what == Afterwards::What::kQuit) app::carryOut(Action::kQuit, p);
}

}  // namespace fettle::app
