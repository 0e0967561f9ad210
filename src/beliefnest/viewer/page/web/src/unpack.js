/** Reader of the data that Python packed into the page. */

/** Return the content of the page's data element. @returns {Promise<object>} */
export async function packedData (element) {
  const { served, packed } = JSON.parse(element.textContent)
  const bytes = Uint8Array.from(atob(packed), letter => letter.charCodeAt(0))
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))
  return { served, content: await new Response(stream).json() }
}
