//! Path preparation: stream adapters over path elements.
