# The picture that is drawn many times a second.
set(LIVE_CPU
  damage.cpp detail.cpp detail_tile.cpp live_overlay.cpp live_view.cpp page_table.cpp patches.cpp pick.cpp
  residency.cpp stereo.cpp tile_copy.cpp)
set(LIVE_VULKAN
  enlarge.cpp live_fields.cpp live_frame.cpp live_panels.cpp live_picture.cpp live_plan.cpp live_redraw.cpp live_texture.cpp page_demand.cpp page_pool.cpp page_set.cpp stereo_compose.cpp
  submissions.cpp)
target_sources(fettle_render PRIVATE ${LIVE_CPU} ${LIVE_VULKAN})
set_source_files_properties(${LIVE_CPU} PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
