# Finds MuJoCo as PyPI's wheel `mujoco` brings it: in the Python that is called python3, or in the folder that
# the variable MUJOCO_DIR names, of CMake or of the environment: the package's, with include/ and libmujoco.so.*.
# Defines MuJoCo_FOUND and MuJoCo::mujoco. Nothing needs it.
if(NOT MUJOCO_DIR)
  set(MUJOCO_DIR "$ENV{MUJOCO_DIR}")
endif()
if(NOT MUJOCO_DIR)
  execute_process(
    COMMAND python3 -c "import importlib.util as u; print(u.find_spec('mujoco').submodule_search_locations[0])"
    OUTPUT_VARIABLE MUJOCO_DIR OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(MUJOCO_DIR)
  file(GLOB MUJOCO_LIBRARY ${MUJOCO_DIR}/libmujoco.so.* ${MUJOCO_DIR}/lib/libmujoco.so.*)
  if(MUJOCO_LIBRARY AND EXISTS ${MUJOCO_DIR}/include/mujoco/mjspec.h)
    list(GET MUJOCO_LIBRARY 0 MUJOCO_LIBRARY)
    add_library(MuJoCo::mujoco SHARED IMPORTED)
    set_target_properties(MuJoCo::mujoco PROPERTIES
      IMPORTED_LOCATION ${MUJOCO_LIBRARY}
      INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${MUJOCO_DIR}/include)
    target_include_directories(MuJoCo::mujoco INTERFACE ${MUJOCO_DIR}/include)
    set(MuJoCo_FOUND TRUE)
    message(STATUS "MuJoCo: ${MUJOCO_LIBRARY}")
  endif()
endif()
