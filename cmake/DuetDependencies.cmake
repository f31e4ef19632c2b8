# Everything comes as a package of the distribution; docs/dependencies.md says why each is here.

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres REQUIRED)
if(Ceres_VERSION VERSION_LESS 2.1)
  message(FATAL_ERROR
    "Duet needs Ceres 2.1 or later (ceres::Manifold); this machine has ${Ceres_VERSION}. "
    "Ubuntu 22.04 ships 2.0: use Debian 12 or Ubuntu 24.04.")
endif()
find_package(OpenCVModules 4 REQUIRED COMPONENTS core imgproc imgcodecs features2d video calib3d)
find_package(gflags REQUIRED)
find_package(glog QUIET CONFIG)
if(NOT TARGET glog::glog)
  find_library(GLOG_LIBRARY glog REQUIRED)
  find_path(GLOG_INCLUDE_DIR glog/logging.h REQUIRED)
  add_library(glog::glog UNKNOWN IMPORTED)
  set_target_properties(glog::glog PROPERTIES IMPORTED_LOCATION "${GLOG_LIBRARY}"
                        INTERFACE_INCLUDE_DIRECTORIES "${GLOG_INCLUDE_DIR}")
endif()
find_package(yaml-cpp REQUIRED)
if(NOT TARGET yaml-cpp::yaml-cpp)
  add_library(yaml-cpp::yaml-cpp ALIAS yaml-cpp)
endif()
find_package(nlohmann_json 3 REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(Boost 1.74 REQUIRED)
find_package(Threads REQUIRED)
