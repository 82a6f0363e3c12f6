#pragma once

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

namespace fettle::engine {

// clang-format off
/// The functions of GDAL that Fettle calls, a row each: a call that is not here is not to be had.
#define FETTLE_GDAL_CALLS(CALL) \
  CALL(CPLErrorReset) \
  CALL(CPLGetErrorHandlerUserData) \
  CALL(CPLPopErrorHandler) \
  CALL(CPLPushErrorHandlerEx) \
  CALL(CPLQuietErrorHandler) \
  CALL(CPLSetConfigOption) \
  CALL(CPLSetErrorHandler) \
  CALL(CPLSetThreadLocalConfigOption) \
  CALL(VSIFree) \
  CALL(CSLDestroy) \
  CALL(CSLSetNameValue) \
  CALL(CSLTokenizeString2) \
  CALL(GDALClose) \
  CALL(GDALCreate) \
  CALL(GDALCreateCopy) \
  CALL(GDALDataTypeIsComplex) \
  CALL(GDALDataTypeIsInteger) \
  CALL(GDALDatasetCommitTransaction) \
  CALL(GDALDatasetCreateLayer) \
  CALL(GDALDatasetGetLayer) \
  CALL(GDALDatasetGetLayerCount) \
  CALL(GDALDatasetStartTransaction) \
  CALL(GDALDatasetTestCapability) \
  CALL(GDALFlushCache) \
  CALL(GDALGetBlockSize) \
  CALL(GDALGetDataTypeSizeBytes) \
  CALL(GDALGetDriverByName) \
  CALL(GDALGetGeoTransform) \
  CALL(GDALGetMaskBand) \
  CALL(GDALGetMaskFlags) \
  CALL(GDALGetMetadata) \
  CALL(GDALGetMetadataItem) \
  CALL(GDALGetOverview) \
  CALL(GDALGetOverviewCount) \
  CALL(GDALGetRasterBand) \
  CALL(GDALGetRasterBandXSize) \
  CALL(GDALGetRasterBandYSize) \
  CALL(GDALGetRasterColorInterpretation) \
  CALL(GDALGetRasterColorTable) \
  CALL(GDALGetRasterCount) \
  CALL(GDALGetRasterDataType) \
  CALL(GDALGetRasterNoDataValue) \
  CALL(GDALGetRasterNoDataValueAsInt64) \
  CALL(GDALGetRasterNoDataValueAsUInt64) \
  CALL(GDALGetRasterOffset) \
  CALL(GDALGetRasterScale) \
  CALL(GDALGetRasterUnitType) \
  CALL(GDALGetRasterXSize) \
  CALL(GDALGetRasterYSize) \
  CALL(GDALGetSpatialRef) \
  CALL(GDALOpenEx) \
  CALL(GDALRasterIO) \
  CALL(GDALReadBlock) \
  CALL(GDALSetCacheMax64) \
  CALL(GDALSetGeoTransform) \
  CALL(GDALSetMetadataItem) \
  CALL(GDALSetRasterNoDataValue) \
  CALL(GDALSetRasterUnitType) \
  CALL(GDALSetSpatialRef) \
  CALL(OGRGeometryTypeToName) \
  CALL(OGR_F_Create) \
  CALL(OGR_F_Destroy) \
  CALL(OGR_F_GetFieldAsDouble) \
  CALL(OGR_F_GetFieldAsInteger) \
  CALL(OGR_F_GetFieldAsInteger64) \
  CALL(OGR_F_GetFieldAsString) \
  CALL(OGR_F_GetFieldDefnRef) \
  CALL(OGR_F_GetFieldIndex) \
  CALL(OGR_F_GetGeometryRef) \
  CALL(OGR_F_IsFieldSetAndNotNull) \
  CALL(OGR_F_SetFieldDouble) \
  CALL(OGR_F_SetFieldInteger) \
  CALL(OGR_F_SetFieldInteger64) \
  CALL(OGR_F_SetFieldString) \
  CALL(OGR_F_SetGeometry) \
  CALL(OGR_Fld_Create) \
  CALL(OGR_Fld_Destroy) \
  CALL(OGR_Fld_GetType) \
  CALL(OGR_GT_Flatten) \
  CALL(OGR_G_AddPoint_2D) \
  CALL(OGR_G_CreateGeometry) \
  CALL(OGR_G_DestroyGeometry) \
  CALL(OGR_G_GetGeometryCount) \
  CALL(OGR_G_GetGeometryRef) \
  CALL(OGR_G_GetGeometryType) \
  CALL(OGR_G_GetPointCount) \
  CALL(OGR_G_GetX) \
  CALL(OGR_G_GetY) \
  CALL(OGR_L_CreateFeature) \
  CALL(OGR_L_CreateField) \
  CALL(OGR_L_GetGeomType) \
  CALL(OGR_L_GetLayerDefn) \
  CALL(OGR_L_GetName) \
  CALL(OGR_L_GetNextFeature) \
  CALL(OGR_L_GetSpatialRef) \
  CALL(OGR_L_ResetReading) \
  CALL(OSRClone) \
  CALL(OSRDestroySpatialReference) \
  CALL(OSRExportToWktEx) \
  CALL(OSRFindMatches) \
  CALL(OSRFreeSRSArray) \
  CALL(OSRGetLinearUnits) \
  CALL(OSRGetName) \
  CALL(OSRGetTargetLinearUnits) \
  CALL(OSRImportFromEPSG) \
  CALL(OSRImportFromESRI) \
  CALL(OSRImportFromWkt) \
  CALL(OSRIsCompound) \
  CALL(OSRIsGeographic) \
  CALL(OSRIsProjected) \
  CALL(OSRIsSameEx) \
  CALL(OSRIsVertical) \
  CALL(OSRNewSpatialReference) \
  CALL(OSRRelease) \
  CALL(OSRSetAxisMappingStrategy) \
  CALL(OSRStripVertical) \
  CALL(VSIFCloseL) \
  CALL(VSIFileFromMemBuffer) \
  CALL(VSIGetMemFileBuffer) \
  CALL(VSIUnlink)

/// Those that register a driver; their headers are for C++ only or name all drivers.
#define FETTLE_GDAL_DRIVERS(CALL) \
  CALL(GDALRegister_COG) \
  CALL(GDALRegister_GTiff) \
  CALL(RegisterOGRDXF) \
  CALL(RegisterOGRGeoJSON) \
  CALL(RegisterOGRGeoPackage)
// clang-format on

/// GDAL by its own names: gdal().GDALOpenEx(...).
struct GdalCalls {
// NOLINTBEGIN(bugprone-macro-parentheses): what is declared is a name
#define FETTLE_CALL(name) decltype(&::name) name = nullptr;
  FETTLE_GDAL_CALLS(FETTLE_CALL)
#undef FETTLE_CALL
#define FETTLE_CALL(name) void (*name)() = nullptr;
  FETTLE_GDAL_DRIVERS(FETTLE_CALL)
#undef FETTLE_CALL
  // NOLINTEND(bugprone-macro-parentheses)
};

/// Loads GDAL when it is first called: with the 88 libraries that it alone needs that takes two thirds of the time in which the
/// program would start, and what reads and writes other formats, or only prints its help, does without. Threading: any.
/// Throws std::runtime_error where the library is not installed, as the loader of a program would end it.
const GdalCalls& gdal();

}  // namespace fettle::engine
