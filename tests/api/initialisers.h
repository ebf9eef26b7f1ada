/* SPDX-License-Identifier: Apache-2.0 */
/* One of each struct that a caller makes, by its initialiser. */
#ifndef SUNDER_TESTS_API_INITIALISERS_H
#define SUNDER_TESTS_API_INITIALISERS_H

#include "sunder/sunder_vulkan.h"

struct initialised {
  sunder_device device;
  sunder_material material;
  sunder_selection selection;
  sunder_support support;
  sunder_instrument instrument;
  sunder_preset_crack crack;
  sunder_fibres fibres;
  sunder_fracture_options fracture;
  sunder_solver_options solver;
  sunder_engine engine;
  sunder_callbacks callbacks;
  sunder_step step;
  sunder_body body;
  sunder_event event;
  sunder_crack grown;
  sunder_tip tip;
  sunder_interface interface_state;
  sunder_surface surface;
  sunder_hand hand;
  sunder_felt felt;
  sunder_frame frame;
  sunder_vulkan_buffer buffer;
  sunder_vulkan_host host;
  sunder_vulkan_display display;
  sunder_vulkan_signals signals;
  sunder_vulkan_items items;
  sunder_vulkan_surface drawn;
};

#define INITIALISED                                                                       \
  {                                                                                       \
    SUNDER_DEVICE_INIT, SUNDER_MATERIAL_INIT, SUNDER_SELECTION_INIT, SUNDER_SUPPORT_INIT, \
        SUNDER_INSTRUMENT_INIT, SUNDER_PRESET_CRACK_INIT, SUNDER_FIBRES_INIT,             \
        SUNDER_FRACTURE_OPTIONS_INIT, SUNDER_SOLVER_OPTIONS_INIT, SUNDER_ENGINE_INIT,     \
        SUNDER_CALLBACKS_INIT, SUNDER_STEP_INIT, SUNDER_BODY_INIT, SUNDER_EVENT_INIT,     \
        SUNDER_CRACK_INIT, SUNDER_TIP_INIT, SUNDER_INTERFACE_INIT, SUNDER_SURFACE_INIT,   \
        SUNDER_HAND_INIT, SUNDER_FELT_INIT, SUNDER_FRAME_INIT, SUNDER_VULKAN_BUFFER_INIT, \
        SUNDER_VULKAN_HOST_INIT, SUNDER_VULKAN_DISPLAY_INIT, SUNDER_VULKAN_SIGNALS_INIT,  \
        SUNDER_VULKAN_ITEMS_INIT, SUNDER_VULKAN_SURFACE_INIT                              \
  }

#endif
