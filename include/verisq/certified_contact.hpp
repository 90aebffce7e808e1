/// How much of a mesh's area lies close to a model's surface, with what proves it again.
#pragma once

#include <cstddef>
#include <functional>
#include <verisq/contact_area.hpp>
#include <verisq/contact_certificate.hpp>
#include <verisq/mesh.hpp>
#include <verisq/model.hpp>

namespace verisq {

struct CertifiedContact {
  ContactTerms terms;
  /// Those found, where the certificate proves them; else wider, as it does.
  ContactClaims claims;
  ContactCertificate certificate;
  ProvenContact proven;  ///< `interrupted`: there is no certificate
};

/// Of what `contact_areas` found with the same arguments, of the mesh; the model's own surface has no certificate.
/// Divides triangles as it does, those of which it is least known what is in contact, until that is known as well as it
/// was found, or the certificate takes more than about so many `bytes` as a file (verisq/certificate_file.hpp).
/// `progress` is told how much is done, from 0 to 1. Throws Error as contact_areas.
[[nodiscard]] CertifiedContact certified_contact(
    const Model& model, const Mesh& mesh, const ContactAreas& found, const ContactAreaOptions& options,
    const std::function<void(double)>& progress = [](double) {}, std::size_t bytes = 60'000'000);

}  // namespace verisq
