# Finds single OpenCV 4 modules (targets OpenCV::core, OpenCV::video, ...). The distribution's
# OpenCVConfig.cmake comes only with libopencv-dev, which pulls in the GUI stack and a gigabyte;
# the modules' own -dev packages have headers and libraries alone.
#
#   find_package(OpenCVModules 4 REQUIRED COMPONENTS core imgproc)

find_path(OpenCVModules_INCLUDE_DIR opencv2/core/version.hpp PATH_SUFFIXES opencv4)
mark_as_advanced(OpenCVModules_INCLUDE_DIR)
if(OpenCVModules_INCLUDE_DIR)
  file(READ "${OpenCVModules_INCLUDE_DIR}/opencv2/core/version.hpp" _opencv_version)
  foreach(part MAJOR MINOR REVISION)
    string(REGEX MATCH "#define CV_VERSION_${part} +([0-9]+)" _ "${_opencv_version}")
    set(_opencv_${part} "${CMAKE_MATCH_1}")
  endforeach()
  set(OpenCVModules_VERSION "${_opencv_MAJOR}.${_opencv_MINOR}.${_opencv_REVISION}")
endif()
foreach(module IN LISTS OpenCVModules_FIND_COMPONENTS)
  find_library(OpenCVModules_${module}_LIBRARY opencv_${module})
  mark_as_advanced(OpenCVModules_${module}_LIBRARY)
  if(OpenCVModules_${module}_LIBRARY AND OpenCVModules_INCLUDE_DIR)
    set(OpenCVModules_${module}_FOUND TRUE)
    if(NOT TARGET OpenCV::${module})
      add_library(OpenCV::${module} UNKNOWN IMPORTED)
      set_target_properties(OpenCV::${module} PROPERTIES
        IMPORTED_LOCATION "${OpenCVModules_${module}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${OpenCVModules_INCLUDE_DIR}")
    endif()
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVModules REQUIRED_VARS OpenCVModules_INCLUDE_DIR
                                  VERSION_VAR OpenCVModules_VERSION HANDLE_COMPONENTS)
