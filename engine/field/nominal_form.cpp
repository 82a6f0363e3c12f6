#include "engine/field/nominal_form.h"

namespace fettle::engine {

NominalForm NominalForm::inverted() const {
  if (const ShapeForm* shape = this->shape()) return shape->inverted();
  PolynomialForm form = *polynomial();
  form.base = -form.base;
  for (double& coefficient : form.coefficients) coefficient = -coefficient;
  return form;
}

}  // namespace fettle::engine
