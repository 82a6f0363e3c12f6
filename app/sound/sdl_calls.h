#pragma once

#include <SDL2/SDL.h>

#include "engine/base/error.h"

namespace fettle::app {

/// The functions of SDL that sound is played with, and no others: its windows and input are never started. The library is loaded when a
/// scene with sound is first played, not with the program: it brings those of sound servers.
struct SdlCalls {
  decltype(&::SDL_SetHint) set_hint = nullptr;
  decltype(&::SDL_InitSubSystem) init_sub_system = nullptr;
  decltype(&::SDL_QuitSubSystem) quit_sub_system = nullptr;
  decltype(&::SDL_OpenAudioDevice) open_audio_device = nullptr;
  decltype(&::SDL_PauseAudioDevice) pause_audio_device = nullptr;
  decltype(&::SDL_CloseAudioDevice) close_audio_device = nullptr;
  decltype(&::SDL_GetCurrentAudioDriver) current_audio_driver = nullptr;
  decltype(&::SDL_GetError) get_error = nullptr;
};

/// They, loaded by the first call; the same object ever after. Errors (kFailed): a library that is not installed, with the package that
/// has it. Thread: main.
[[nodiscard]] engine::Result<const SdlCalls*> sdlCalls();

}  // namespace fettle::app
