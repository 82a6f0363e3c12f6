#include "app/sound/sdl_calls.h"

#include <dlfcn.h>

#include "engine/base/loaded_library.h"

namespace fettle::app {

namespace {

// ALSA, with which SDL is linked, writes what it tries to standard error line by line; the error that SDL returns is enough.
// NOLINTNEXTLINE(cert-dcl50-cpp): as ALSA declares it.
void ignoreAlsaError(const char*, int, const char*, int, const char*, ...) {}

void quietAlsa() {
  void* const alsa = dlopen("libasound.so.2", RTLD_LAZY | RTLD_NOLOAD);
  if (alsa == nullptr) return;
  using SetHandler = int(decltype(&ignoreAlsaError));
  // It stays loaded as long as SDL does.
  if (auto* const set = reinterpret_cast<SetHandler*>(dlsym(alsa, "snd_lib_error_set_handler")))
    set(&ignoreAlsaError);
}

engine::Result<SdlCalls> loadedSdl() {
  SdlCalls calls;
  engine::LoadedLibrary sdl("libSDL2-2.0.so.0", "libsdl2-2.0-0");
  sdl.find("SDL_SetHint", calls.set_hint);
  sdl.find("SDL_InitSubSystem", calls.init_sub_system);
  sdl.find("SDL_QuitSubSystem", calls.quit_sub_system);
  sdl.find("SDL_OpenAudioDevice", calls.open_audio_device);
  sdl.find("SDL_PauseAudioDevice", calls.pause_audio_device);
  sdl.find("SDL_CloseAudioDevice", calls.close_audio_device);
  sdl.find("SDL_GetCurrentAudioDriver", calls.current_audio_driver);
  sdl.find("SDL_GetError", calls.get_error);
  if (auto status = sdl.status("no sound can be played", "sound", ", or take \"sound\" out of the scene");
      !status)
    return tl::unexpected(status.error());
  quietAlsa();
  return calls;
}

}  // namespace

engine::Result<const SdlCalls*> sdlCalls() {
  static const engine::Result<SdlCalls> calls = loadedSdl();
  if (!calls) return tl::unexpected(calls.error());
  return &*calls;
}

}  // namespace fettle::app
